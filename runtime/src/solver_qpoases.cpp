// Back end qpOASES (Ferreau et al. 2014): an online active-set method that follows the QP from cycle to
// cycle.
//
// The only file that includes qpOASES. What it has to respect, each with a test in
// runtime/tests/test_solver.c:
//   - rows keep their slots and are never zero (rows.c), else a hot start succeeds with a wrong solution;
//   - the limit of working-set changes is an in-out argument, and reaching it is a failure;
//   - after a failure or an infeasible QP the object has to be reset, or later cycles fail too;
//   - it may write into the Hessian that it is given, so it gets a copy;
//   - what it may print, and where to, are settings for the whole process, which others change;
//   - it allocates in every call: this back end is never free of heap use.
#include "solver.h"

#include <qpOASES.hpp>

#include <cstdio>
#include <cstring>
#include <new>

namespace {

constexpr int n = PG_N;
constexpr int rows = PG_ROWS;
constexpr int slacks = PG_RELAXATION_SLACK ? rows : 0;
constexpr int variables = n + slacks; // x = [q_dot; s]

// Bounds that are closer to each other are one value, and shorter steps are none, in a sharp attempt; by
// default 2e-10 and 1e-9, with which it halts at working sets that are not those of the solution.
constexpr double sharp = 1e-14;

// Defaults, which were the most reliable of the three sets, except:
qpOASES::Options options(bool is_sharp) {
  qpOASES::Options options;
  if (is_sharp) options.boundTolerance = options.terminationTolerance = sharp;
  options.printLevel = qpOASES::PL_NONE;
  options.enableFullLITests = qpOASES::BT_TRUE;     // without, 1 in 100 infeasible QPs ends as a failure
  options.enableNZCTests = qpOASES::BT_FALSE;       // H is positive definite: there is no direction
  options.enableFlippingBounds = qpOASES::BT_FALSE; // of zero curvature to look for
  return options;
}

// What qpOASES may print is one setting for the whole process. Its constructor switches errors on, and so
// does its destructor, for the controllers that live on: hence before every call that could have something to
// say.
void silence() {
  qpOASES::MessageHandling *const messages = qpOASES::getGlobalMessageHandler();
  messages->setErrorVisibilityStatus(qpOASES::VS_HIDDEN);
  messages->setWarningVisibilityStatus(qpOASES::VS_HIDDEN);
  messages->setInfoVisibilityStatus(qpOASES::VS_HIDDEN);
}

// Another thread may switch it on between that and the message. So what is printed goes nowhere: not now, and
// not after a destructor, which sends it back to stdFile.
void discard_messages() {
  static std::FILE *const nowhere =
      qpOASES::stdFile == stdout || qpOASES::stdFile == stderr ? std::fopen("/dev/null", "w") : nullptr;
  if (!nowhere || qpOASES::stdFile == nowhere) return;
  qpOASES::stdFile = nowhere;
  qpOASES::getGlobalMessageHandler()->setOutputFile(nowhere);
}

// Lets the multipliers be read when there is no solution.
class Problem : public qpOASES::SQProblem {
public:
  using SQProblem::SQProblem;
  const double *multipliers() const {
    return y;
  }
};

} // namespace

struct pg_solver {
  Problem problem{variables, rows, qpOASES::HST_POSDEF};
  qpOASES::Bounds bounds;           // working set of the last solution
  qpOASES::Constraints constraints; // likewise
  bool has_working_set = false;
  bool hot = false; // `problem` holds a solution to start from

  double H[variables * variables] = {};
  double g[variables] = {};
  double A[rows * variables] = {};
  double lb[variables] = {};
  double ub[variables] = {};
  double lbA[rows] = {};

  pg_solver();
  void load(const pg_qp_t &qp);
  qpOASES::returnValue start_hot(const double *ubA, qpOASES::int_t &changes);
  qpOASES::returnValue start_cold(const double *ubA, bool guess, qpOASES::int_t &changes);
  void remember();
  void forget();
};

pg_solver::pg_solver() {
  problem.setOptions(options(false));
  for (int i = 0; i < rows; i++)
    lbA[i] = -PG_OFF;
  for (int i = 0; i < slacks; i++) {
    ub[n + i] = PG_OFF;
    A[i * variables + n + i] = -1.0;
  }
}

// The QP as qpOASES wants it; with soft rows [H 0; 0 diag(rho)] and [A -I].
void pg_solver::load(const pg_qp_t &qp) {
  for (int i = 0; i < n; i++)
    std::memcpy(&H[i * variables], &qp.H[i * n], n * sizeof(double));
  for (int i = 0; i < rows; i++)
    std::memcpy(&A[i * variables], &qp.A[i * n], n * sizeof(double));
  for (int i = 0; i < slacks; i++)
    H[(n + i) * variables + n + i] = 1.0 / qp.softness[i];
  std::memcpy(g, qp.g, n * sizeof(double));
  std::memcpy(lb, qp.lb, n * sizeof(double));
  std::memcpy(ub, qp.ub, n * sizeof(double));
}

qpOASES::returnValue pg_solver::start_hot(const double *ubA, qpOASES::int_t &changes) {
  return problem.hotstart(H, g, A, lb, ub, lbA, ubA, changes);
}

qpOASES::returnValue pg_solver::start_cold(const double *ubA, bool guess, qpOASES::int_t &changes) {
  problem.reset();
  return problem.init(H, g, A, lb, ub, lbA, ubA, changes, nullptr, nullptr, nullptr,
                      guess ? &bounds : nullptr, guess ? &constraints : nullptr);
}

void pg_solver::remember() {
  problem.getBounds(bounds);
  problem.getConstraints(constraints);
  has_working_set = true;
}

void pg_solver::forget() {
  problem.reset();
  hot = has_working_set = false;
}

extern "C" {

const char pg_solver_name[] = "qpoases";

pg_status_t pg_solver_create(void *memory, pg_solver_t **solver) {
  (void)memory; // qpOASES objects live on the heap
  try {
    discard_messages();
    *solver = new pg_solver();
  } catch (...) {
    return PG_ERROR_MEMORY;
  }
  return PG_SOLVED;
}

void pg_solver_destroy(pg_solver_t *solver) {
  delete solver;
  silence();
}

void pg_solver_reset(pg_solver_t *solver) {
  solver->forget();
}

void pg_solver_load(pg_solver_t *solver, const pg_qp_t *qp) {
  solver->load(*qp);
}

int pg_solver_is_at_hand(const pg_solver_t *solver, const pg_qp_t *qp) {
  (void)solver, (void)qp; // every answer has to be worked for
  return 0;
}

pg_outcome_t pg_solver_solve(pg_solver_t *solver, const pg_qp_t *qp, pg_start_t start,
                             pg_solution_t *solution) {
  *solution = pg_solution_t{};
  qpOASES::int_t changes = PG_MAX_ITERATIONS;
  try {
    if (start == PG_SHARP) solver->problem.setOptions(options(true));
    silence();
    const qpOASES::returnValue result =
        start == PG_FIRST && solver->hot
            ? solver->start_hot(qp->ubA, changes)
            : solver->start_cold(qp->ubA, start == PG_FIRST && solver->has_working_set, changes);
    if (start == PG_SHARP) solver->problem.setOptions(options(false));
    solution->iterations = changes;
    solver->hot = result == qpOASES::SUCCESSFUL_RETURN;
    // qpOASES counts multipliers of upper bounds as negative. Without a solution, those that have grown while
    // it tried are the ones of rows that contradict each other: in two of three cases a proof.
    const double *y = solver->problem.multipliers() + variables;
    for (int i = 0; i < rows; i++)
      solution->y[i] = y[i] < 0.0 ? -y[i] : 0.0;
    if (!solver->hot) return solver->problem.isInfeasible() ? PG_INFEASIBLE : PG_UNSOLVED;

    double x[variables];
    solver->problem.getPrimalSolution(x);
    std::memcpy(solution->x, x, sizeof solution->x);
    solver->remember();
    return PG_OPTIMAL;
  } catch (...) { // memory ran out
    solver->hot = false;
    return PG_UNSOLVED;
  }
}

} // extern "C"
