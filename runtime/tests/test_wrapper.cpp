// The C++ wrapper: values in, values out, one owner, and no exception anywhere.
#include "check.h"
#include "controller.hpp"

#include <string_view>
#include <type_traits>

static_assert(!std::is_copy_constructible_v<planar::Controller> &&
              !std::is_copy_assignable_v<planar::Controller>);
static_assert(std::is_nothrow_move_constructible_v<planar::Controller>);
static_assert(noexcept(std::declval<planar::Controller &>().step({}, {}, {})));

static void cycles() {
  planar::Controller controller;
  CHECK(controller && controller.status() == PG_SOLVED);
  planar::Measurement seen;
  seen.time = 0.02;
  planar::Command command = controller.step({0.3, 0.6}, {0.1, 0.1}, seen);
  CHECK(command.success() && !command.stopped() && command.status == PG_SOLVED);
  CHECK(std::string_view(command.name()) == "SOLVED");
  CHECK(controller.diagnostics()->solves == 1);

  const planar::Point points[] = {{0.3, 0.2, 0.0}, {0.4, -0.2, 0.0}};
  seen.points = points;
  seen.point_count = 2;
  seen.time += 0.02;
  CHECK(controller.step({0.3, 0.6}, {0.1, 0.1}, seen).status <= PG_REDUCED_REPULSION);
  CHECK(controller.diagnostics()->distance[0] < 0.3);
  seen.point_count = PLANAR_MAX_POINTS + 1;
  CHECK(controller.step({0.3, 0.6}, {0.1, 0.1}, seen).status == PG_ERROR_SIZE);
  seen.point_count = 0;
  seen.tof_age.emplace().fill(1.0);
  seen.time += 0.02;
  command = controller.step({0.3, 0.6}, {0.1, 0.1}, seen);
  CHECK(command.stopped() && command.status == PG_FAULT_STALE);
  CHECK(controller.counters().cycles == 3 && controller.counters().errors == 1);
  CHECK(controller.reset() == PG_SOLVED);
}

static void parameters() {
  planar::Controller controller;
  planar::Parameters p;
  CHECK(controller.get(p) == PG_SOLVED);
  p.d_a = 0.5;
  CHECK(controller.set(p) == PG_SOLVED);
  p.d_a = -1.0;
  CHECK(controller.set(p) == PG_ERROR_PARAMETER);
  CHECK(controller.get(p) == PG_SOLVED && p.d_a == 0.5);
}

static void ownership() {
  planar::Controller first;
  planar::Controller second(std::move(first));
  CHECK(!first && second);
  CHECK(first.step({}, {}, {}).status == PG_ERROR_NULL);
  CHECK(first.diagnostics() == nullptr && first.reset() == PG_ERROR_NULL);
  first = std::move(second);
  CHECK(first && !second);

  static unsigned char block[PLANAR_MEMORY_SIZE];
  planar::Controller inside(block, sizeof block), too_small(block, 10);
  CHECK(inside && !too_small && too_small.status() == PG_ERROR_SIZE);
  CHECK(planar::version().abi == PG_ABI_VERSION);
}

int main() {
  cycles();
  parameters();
  ownership();
  return checks_failed > 0;
}
