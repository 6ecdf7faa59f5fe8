// The same loop in C++17: a range sensor that sees something, readings of different ages, thresholds changed
// while it runs, diagnostics.
//
//     loop [SECONDS]
#include <iiwa7/controller.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <thread>

using Clock = std::chrono::steady_clock;
using std::chrono::microseconds;
using std::chrono::milliseconds;

namespace {

constexpr milliseconds period{1};

// Wakes at absolute deadlines, and keeps count of what came too late.
class Metronome {
public:
  // False if the next deadline has passed by more than a period: the caller leaves this cycle out.
  bool wait() {
    deadline_ += period;
    if (Clock::now() >= deadline_ + period) {
      skipped_++;
      return false;
    }
    std::this_thread::sleep_until(deadline_);
    latest_ = std::max(latest_, Clock::now() - deadline_);
    return true;
  }
  void finish() {
    cycles_++;
    overruns_ += Clock::now() >= deadline_ + period;
  }
  double time() const {
    return std::chrono::duration<double>(Clock::now() - begin_).count();
  }
  void report() const {
    const auto late = std::chrono::duration_cast<microseconds>(latest_).count();
    std::printf("cycles: %ld at 1 kHz, %ld deadlines left out\n", cycles_, skipped_);
    std::printf("overruns: %ld; started at most %ld us late\n", overruns_, static_cast<long>(late));
  }

private:
  Clock::time_point begin_ = Clock::now(), deadline_ = begin_;
  Clock::duration latest_{};
  long cycles_ = 0, overruns_ = 0, skipped_ = 0;
};

// Modules that are read every 10 ms, one tenth of them in each cycle.
class Skin {
public:
  Skin() {
    seen_.tof_age.emplace();
    seen_.capacitive_age.emplace();
  }
  // What they said last, and how long ago.
  const iiwa7::Measurement &read(double time) {
    const bool first = cycle_ == 0;
    for (std::size_t i = 0; i < taken_.size(); i++) {
      if (first || cycle_ % every == i % every) {
        taken_[i] = time;
        if (i == 0) seen_.tof_range[i] = 0.15 + 0.10 * std::cos(time); // [m] the others see nothing
      }
      (*seen_.tof_age)[i] = (*seen_.capacitive_age)[i] = time - taken_[i];
    }
    cycle_++;
    seen_.time = time;
    return seen_;
  }

private:
  static constexpr std::size_t every = 10;
  iiwa7::Measurement seen_{};
  std::array<double, IIWA7_TOF> taken_{}; // [s]
  std::size_t cycle_ = 0;
};

bool set_up(iiwa7::Controller &controller) {
  iiwa7::Parameters parameters{};
  if (controller.get(parameters) != PG_SOLVED) return false;
  parameters.period = std::chrono::duration<double>(period).count();
  parameters.max_period = 0.02; // a cycle that comes later brakes
  return controller.set(parameters) == PG_SOLVED;
}

// Keeps more distance from now on.
bool be_careful(iiwa7::Controller &controller) {
  iiwa7::Parameters parameters{};
  if (controller.get(parameters) != PG_SOLVED) return false;
  parameters.d_a = 0.40;
  parameters.d_0u = 0.30;
  return controller.set(parameters) == PG_SOLVED;
}

} // namespace

int main(int argc, char **argv) {
  const long count = std::lround((argc > 1 ? std::atof(argv[1]) : 2.0) * 1000.0);
  iiwa7::Controller controller;
  if (!controller || !set_up(controller)) {
    std::printf("no controller: %s\n", iiwa7_status_name(controller.status()));
    return 1;
  }
  iiwa7::JointVector q{0.0, 0.5, 0.0, -1.5, 0.0, 1.0, 0.0};
  double nearest = INFINITY;
  Skin skin;
  Metronome metronome;
  for (long passed = 0; passed < count; passed++) {
    if (passed == count / 2 && !be_careful(controller)) return 1;
    if (!metronome.wait()) continue;
    const iiwa7::Command command = controller.step(q, {0.0, 0.05, 0.0}, skin.read(metronome.time()));
    if (command.status < PG_SOLVED) return 1; // a wrong call
    for (std::size_t j = 0; j < q.size(); j++)
      q[j] += 1e-3 * command.qdot[j];
    for (const double distance : controller.diagnostics()->distance)
      nearest = std::min(nearest, distance);
    metronome.finish();
  }
  metronome.report();
  const iiwa7::Counters counters = controller.counters();
  for (int status = 0; status < 32; status++)
    if (counters.status_count[status])
      std::printf("%s: %llu\n", iiwa7_status_name(static_cast<pg_status_t>(status)),
                  counters.status_count[status]);
  std::printf("nearest: %.3f m\n", nearest);
}
