#include "tests/view/results.h"

#include "cosim/trace/trace_row.h"
#include "physics/render/arena_file.h"
#include "tests/kit/scratch.h"

#include <fmt/format.h>

#include <fstream>

namespace puckloop::tests {

namespace fs = std::filesystem;

void write_text(const fs::path& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
}

namespace {

constexpr cosim::Time kBit = cosim::kSecond / 115'200;

std::string trace() {
    std::string text = std::string(cosim::kTraceColumns) + "\n";
    const auto add = [&](cosim::TraceRow row) { text += to_csv(row) + "\n"; };
    const auto led = [&](double at, const char* name, double value) {
        cosim::TraceRow row;
        row.time = cosim::from_seconds(at);
        row.link = "robot0.world";
        row.from = "robot0.pic";
        row.signal = name;
        row.payload = cosim::Signal{0, value};
        add(row);
    };
    led(0.25, "led3", 1);
    for (int i = 0; i < 3; ++i) {  // on a cable: bytes without a pause, 100 ms apart
        const cosim::Time start = cosim::from_seconds(0.5 + 0.1 * i);
        cosim::TraceRow row;
        row.link = "robot0.uart1";
        row.from = "robot0.pic";
        cosim::UartFrame frame;
        frame.start = start;
        frame.bit_period = kBit;
        frame.data = static_cast<std::uint16_t>('A' + i);
        row.time = start + 9 * kBit;
        row.payload = frame;
        if (i == 1) row.fault = cosim::FaultKind::Flip;
        add(row);
    }
    led(1.25, "led3", 0);
    return text;
}

}  // namespace

fs::path write_results(const std::string& name) {
    const fs::path folder = scratch_path(name);
    fs::remove_all(folder);
    fs::create_directories(folder);
    physics::World world;
    world.arena = physics::rectangular_arena(1.0, 0.8);
    physics::Robot robot;
    robot.name = "robot0";
    world.robots.push_back(robot);
    physics::Box box;
    box.name = "carton";
    box.x = 0.3;
    world.boxes.push_back(box);
    physics::write_arena_file(world, folder / "arena.json");
    std::string poses = "t_s,robot,x_m,y_m,theta_rad\n", sensors = "t_s,robot,proximity0,battery_v\n";
    for (int i = 0; i <= 20; ++i) {
        poses += fmt::format("{:.3f},robot0,{:.6f},0.000000,0.000000\n", 0.1 * i, 0.01 * i);
        sensors += fmt::format("{:.3f},robot0,{},4.0\n", 0.1 * i, i);
    }
    write_text(folder / "trajectory.csv", poses);
    write_text(folder / "sensors.csv", sensors);
    write_text(folder / "trace.csv", trace());
    write_text(folder / "robot0.pic.log", "[    0.000000 s] power-on, reset POR\n"
                                          "no time here\n[    1.500000 s] uart1 prints: hello\n");
    write_text(
        folder / "report.json",
        R"({"format":1,"scenario":"/somewhere/a.toml","seed":7,"success":true,"ended_why":"over",)"
        R"("simulated_s":2.0,"warnings":["robot0.pic: look here"],"failures":[],)"
        R"("nodes":{"robot0.pic":{"resets":[{"time_s":0.0,"cause":"POR"},{"time_s":1.0,"cause":"MCLR"}]}}})");
    return folder;
}

}  // namespace puckloop::tests
