#include "reproductions/rab/measure.h"

#include "base/error.h"
#include "cosim/conductor.h"
#include "emu/image/image.h"
#include "emu/rab_board/rab_node.h"
#include "physics/ir/ir_node.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::tools {

namespace {

constexpr double kArena = 6.0;     // m: its walls are out of reach
constexpr double kFarApart = 1.0;  // m, where the robots stand before the first pose
constexpr const char* kNames[] = {"robot0", "robot1"};

physics::World stage_world(const RabMeasurement& what, std::uint64_t seed) {
    physics::World world;
    world.seed = seed;
    world.arena = physics::rectangular_arena(kArena, kArena);
    world.parameters = what.parameters;
    for (const char* name : kNames) {
        physics::Robot robot;
        robot.name = name;
        robot.x = world.robots.empty() ? 0.0 : kFarApart;
        robot.rab = true;
        const auto signals = rab::signals();
        for (std::size_t i = 0; i < signals.size(); ++i)
            robot.rab_signals[signals[i].name] = static_cast<std::uint16_t>(i);
        world.robots.push_back(std::move(robot));
    }
    return world;
}

std::vector<RabReadingRow> measure_pair(const RabMeasurement& what, const image::Image& image, int pair,
                                        const std::function<void(double)>& progress,
                                        const volatile std::sig_atomic_t* interrupted, RabMeasured& total) {
    const auto seed = what.seed * 1000 + static_cast<std::uint64_t>(pair);
    StagePlan plan;
    plan.distances = what.distances;
    plan.repeats = what.repeats;
    plan.power = what.power;
    plan.turn = what.turn;
    plan.one_emitter = what.one_emitter;
    plan.poll_period = what.poll_period;
    plan.seed = seed;
    std::vector<RabReadingRow> rows;
    const auto factory = [&](const std::string& kind) -> std::unique_ptr<cosim::Node> {
        if (kind == "stage") return std::make_unique<StageNode>(plan, rows);
        if (kind == "ir")
            return std::make_unique<physics::IrNode>(stage_world(what, seed), physics::IrNodeOptions{});
        rab::RabNodeOptions options;
        options.board.name = kind + ".rab";
        options.board.seed = seed;
        return std::make_unique<rab::RabNode>(image, options);
    };
    std::vector<cosim::NodeSpec> nodes{{"stage", "stage"}, {"ir", "ir"}};
    std::vector<cosim::LinkSpec> links{{"ir.world", {"ir", "world"}, {"stage", "poses"}}};
    for (std::size_t i = 0; i < std::size(kNames); ++i) {
        const std::string name = kNames[i];
        nodes.push_back({name + ".rab", name});
        links.push_back({name + ".ir", {name + ".rab", "ir"}, {"ir", name + ".ir"}});
        links.push_back({name + ".i2c", {"stage", fmt::format("i2c{}", i)}, {name + ".rab", "i2c"}});
    }
    cosim::RunOptions options;
    options.duration = cosim::from_seconds(plan.duration());
    options.in_process = true;
    options.interrupted = interrupted;
    options.progress = [&](const cosim::Progress& p) {
        progress(cosim::to_seconds(p.time) / plan.duration());
    };
    cosim::Conductor conductor(nodes, links, {}, options, factory);
    const cosim::Outcome outcome = conductor.run();
    if (!outcome.success || outcome.reason == cosim::EndReason::Interrupted) throw RunError(outcome.text);
    total.simulated_s += cosim::to_seconds(outcome.simulated);
    total.wall_s += outcome.wall_s;
    return rows;
}

}  // namespace

RabMeasured measure_rab(const RabMeasurement& what, const std::function<void(double)>& progress,
                        const volatile std::sig_atomic_t* interrupted) {
    const image::Image image = image::load_image(what.firmware.string());
    RabMeasured measured;
    for (int pair = 0; pair < what.pairs; ++pair) {
        const auto rows = measure_pair(
            what, image, pair, [&](double share) { progress((pair + share) / what.pairs); }, interrupted,
            measured);
        measured.rows.insert(measured.rows.end(), rows.begin(), rows.end());
    }
    return measured;
}

}  // namespace puckloop::tools
