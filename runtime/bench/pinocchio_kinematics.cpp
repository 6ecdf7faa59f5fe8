/* The same kinematics from the generated code and from Pinocchio's C++, in turns over the same states.
 *
 *     pinocchio_kinematics INPUT OUTPUT PASSES
 *
 * INPUT holds doubles: number of states; per joint a placement (3x4, row by row), an axis and whether it is
 * prismatic; the tool's body and its placement; then the states. OUTPUT gets doubles: the greatest difference
 * between the two Jacobians, then PASSES times the time per state of the generated code, then as many of
 * Pinocchio. One pass goes over all states, so that the clock is read once for thousands of calls. */
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/multibody.hpp>

extern "C" {
#include "binding.h"
}

namespace {

using Matrix = Eigen::Matrix<double, 6, Eigen::Dynamic>;
using State = Eigen::VectorXd;

pinocchio::SE3 placement(const double *&next) {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
  for (int row = 0; row < 3; row++, next += 4) {
    rotation.row(row) << next[0], next[1], next[2];
    translation[row] = next[3];
  }
  return pinocchio::SE3(rotation, translation);
}

/* Joints about the coordinate axes have cheaper types of their own, which Pinocchio's URDF reader takes, too.
 */
pinocchio::JointModel joint_type(const Eigen::Vector3d &axis, bool prismatic) {
  using namespace pinocchio;
  if (axis == Eigen::Vector3d::UnitX())
    return prismatic ? JointModel(JointModelPX()) : JointModel(JointModelRX());
  if (axis == Eigen::Vector3d::UnitY())
    return prismatic ? JointModel(JointModelPY()) : JointModel(JointModelRY());
  if (axis == Eigen::Vector3d::UnitZ())
    return prismatic ? JointModel(JointModelPZ()) : JointModel(JointModelRZ());
  return prismatic ? JointModel(JointModelPrismaticUnaligned(axis))
                   : JointModel(JointModelRevoluteUnaligned(axis));
}

std::vector<double> read_all(const char *name) {
  std::vector<double> values;
  if (std::FILE *file = std::fopen(name, "rb")) {
    for (double value; std::fread(&value, sizeof value, 1, file) == 1;)
      values.push_back(value);
    std::fclose(file);
  }
  return values;
}

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

} // namespace

int main(int argc, char **argv) {
  if (argc != 4) return 2;
  const std::vector<double> input = read_all(argv[1]);
  if (input.empty()) return 3;
  const double *next = input.data();
  const auto count = static_cast<std::size_t>(*next++);

  pinocchio::Model model;
  for (int j = 0; j < PG_N; j++) {
    const pinocchio::SE3 place = placement(next);
    const Eigen::Vector3d axis(next[0], next[1], next[2]);
    model.addJoint(static_cast<pinocchio::JointIndex>(j), joint_type(axis, next[3] != 0.0), place,
                   "joint_" + std::to_string(j));
    next += 4;
  }
  const auto body = static_cast<pinocchio::JointIndex>(*next++);
  const auto tool =
      model.addFrame(pinocchio::Frame("tool", body, 0, placement(next), pinocchio::FrameType::OP_FRAME));
  pinocchio::Data data(model);
  if (input.size() != static_cast<std::size_t>(next - input.data()) + count * PG_N) return 4;

  std::vector<State> states;
  for (std::size_t i = 0; i < count; i++)
    states.emplace_back(Eigen::Map<const State>(next + i * PG_N, PG_N));
  Matrix jacobian = Matrix::Zero(6, PG_N);
  pg_kinematics_t kinematics;
  const auto by_pinocchio = [&](const State &q) {
    pinocchio::computeJointJacobians(model, data, q);
    pinocchio::updateFramePlacement(model, data, tool);
    jacobian.setZero();
    pinocchio::getFrameJacobian(model, data, tool, pinocchio::LOCAL_WORLD_ALIGNED, jacobian);
  };

  double worst = 0.0;
  for (const State &q : states) {
    pg_model_kinematics(q.data(), &kinematics);
    by_pinocchio(q);
    for (int row = 0; row < PG_M && row < 3; row++)
      for (int j = 0; j < PG_N; j++)
        worst = std::fmax(worst, std::fabs(kinematics.J[row * PG_N + j] - jacobian(row, j)));
  }

  const int passes = std::atoi(argv[3]);
  std::vector<double> ours, theirs;
  for (int pass = 0; pass < passes; pass++) {
    double begin = now();
    for (const State &q : states)
      pg_model_kinematics(q.data(), &kinematics);
    ours.push_back((now() - begin) / static_cast<double>(count));
    begin = now();
    for (const State &q : states)
      by_pinocchio(q);
    theirs.push_back((now() - begin) / static_cast<double>(count));
  }

  std::FILE *file = std::fopen(argv[2], "wb");
  if (!file) return 5;
  const bool written = std::fwrite(&worst, sizeof worst, 1, file) == 1 &&
                       std::fwrite(ours.data(), sizeof(double), ours.size(), file) == ours.size() &&
                       std::fwrite(theirs.data(), sizeof(double), theirs.size(), file) == theirs.size();
  return std::fclose(file) == 0 && written ? 0 : 6;
}
