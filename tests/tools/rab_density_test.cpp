// Range and bearing against density: what is counted of frames and of steps, and a short run of real boards.

#include "base/error.h"
#include "reproductions/density/density.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

using namespace puckloop;
using namespace puckloop::tools;

namespace {

Fate fate(const char* sender, const char* receiver, double time, double distance, bool delivered,
          Cause cause = Cause::Collision) {
    Fate one;
    one.frame.sender = sender;
    one.frame.receiver = receiver;
    one.frame.start = cosim::from_seconds(time);
    one.frame.distance = distance;
    one.delivered = delivered;
    one.cause = cause;
    return one;
}

}  // namespace

TEST_CASE("frames are counted by distance, steps by pair") {
    const Density density = density_of(
        {fate("a", "b", 0.99, 0.2, true),                                   // before
         fate("a", "b", 1.00, 0.2, true), fate("a", "b", 1.05, 0.2, true),  // one step
         fate("a", "b", 1.15, 0.2, false, Cause::Collision), fate("a", "b", 1.45, 0.2, true),
         fate("b", "a", 1.20, 0.2, false, Cause::QueueFull), fate("a", "c", 1.30, 0.6, true),  // no neighbour
         fate("a", "d", 1.30, 1.2, true),                                                      // in no class
         fate("a", "b", 1.50, 0.2, true)},                                                     // behind
        1.0, 1.5);
    const DensityClass& near = density.classes[0];
    CHECK(near.frames == 5);
    CHECK(near.heard == 3);
    CHECK(near.steps == 10);  // two pairs, five steps
    CHECK(near.steps_heard == 2);
    CHECK(near.lost[static_cast<std::size_t>(Cause::Collision)] == 1);
    CHECK(near.lost[static_cast<std::size_t>(Cause::QueueFull)] == 1);
    CHECK(density.classes[1].frames == 0);
    CHECK(density.classes[2].frames == 1);
    CHECK(density.neighbours.frames == near.frames);
    CHECK(density.neighbours.share_of_steps() == Approx(0.2));
    Density twice = density;
    twice.add(density);
    CHECK(twice.neighbours.frames == 10);
    CHECK(twice.neighbours.share() == Approx(0.6));
}

TEST_CASE("the table has a row for each team, and the CSV one for each class of distance") {
    const Density density = density_of({fate("a", "b", 0.0, 0.3, false, Cause::QueueFull)}, 0.0, 0.1);
    const std::vector<DensityRow> rows{{"default", 2, 4, 3, density}, {"set", 20, 1, 1, {}}};
    const std::string table = density_table(rows), csv = density_csv(rows);
    CHECK(table.find("0.000  queue_full") != std::string::npos);
    CHECK(table.find("Published calibrations: 0.7 for two robots, 0.15 for twenty") != std::string::npos);
    CHECK(std::count(csv.begin(), csv.end(), '\n') == 1 + 2 * 4);
    CHECK(csv.find("default,2,4,3,0.25,0.5,1,0,1,0,0,1,") != std::string::npos);
    const std::string picture = density_picture(rows, "caption");
    CHECK(picture.find("4 bytes") != std::string::npos);
    CHECK(picture.find("caption; dashed: set") != std::string::npos);
    CHECK(picture.find("nan") == std::string::npos);
}

TEST_CASE("five robots with the project's firmware hear their neighbours, each time alike") {
    DensitySpec spec;
    spec.folder = tests::scratch_path("rab_density");
    spec.firmware = PUCKLOOP_SOURCE "/firmware/rab/rab.hex";
    spec.robots = 5;
    spec.bytes = 2;
    spec.seconds = 0.3;
    spec.seed = 4;
    const Density first = run_density(spec), second = run_density(spec);
    std::size_t frames = 0, heard = 0;
    for (std::size_t i = 0; i < first.classes.size(); ++i) {
        CHECK(first.classes[i].frames == second.classes[i].frames);
        CHECK(first.classes[i].heard == second.classes[i].heard);
        frames += first.classes[i].frames;
        heard += first.classes[i].heard;
    }
    CHECK(frames > 50);
    CHECK(heard > 10);
    // With light that reaches nobody nothing is heard.
    spec.parameters["ir.reach"] = 0.05;
    const Density dark = run_density(spec);
    for (const DensityClass& one : dark.classes)
        CHECK(one.heard == 0);
    spec.parameters["ir.reech"] = 1;
    CHECK_THROWS_AS(run_density(spec), InputError);
    spec.parameters.clear();
    spec.firmware = PUCKLOOP_SOURCE "/firmware/epuck/epuck.hex";
    CHECK_THROWS(run_density(spec));
}
