// puckloop-coordinator: the coordinator of a set of TAMs. It talks to them through an XBee module at a serial
// port, a real one as well as an emulated one. docs/coordinator.md
//
// Exit status: 0 the experiment ran its time, came to its end or was ended by a signal; 1 the module or the
// port failed; 2 wrong use, or a port or file that cannot be opened.

#include "base/error.h"
#include "linuxboard/coordinator/coordinator.h"
#include "linuxboard/coordinator/experiments/experiments.h"
#include "linuxboard/coordinator/gantt.h"
#include "linuxboard/coordinator/posix_line.h"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>

namespace {

using namespace puckloop;
using namespace puckloop::coordinator;

constexpr int kFailed = 1, kWrongUse = 2;
constexpr double kLongest = 1e9;  // s

volatile std::sig_atomic_t stop_requested = 0;

void request_stop(int) {
    stop_requested = 1;
}

void catch_signals() {
    struct sigaction action {};
    action.sa_handler = request_stop;                  // no SA_RESTART: waits end early
    action.sa_flags = static_cast<int>(SA_RESETHAND);  // a second Ctrl-C ends the program at once
    ::sigaction(SIGINT, &action, nullptr);
    ::sigaction(SIGTERM, &action, nullptr);
}

constexpr Parameter kParameters[] = {
    {"experiment", "random-task", "random-task or sequence"},
    {"port", "/dev/ttyUSB0", "serial port of the XBee module, 9600 8N1"},
    {"duration", "0", "s of the experiment; 0: until Ctrl-C, or until it ends by itself"},
    {"out", ".", "folder for the results"},
    {"events", "tam_events.csv", "event table, in that folder; none: no table"},
    {"gantt", "tam_gantt.svg", "picture, in that folder; none: no picture"},
    {"end-wait", "10", "s at most for the LEDs to go off at the end"},
    {"discover-every", "600", "s between two node discoveries"},
    {"shut-down", nullptr, "switch the TAMs off at the end"},
    {"quiet", nullptr, "print no events"},
    {"config", "", "TOML file with these parameters, named with _ or -"},
    {"draw", "", "draw the picture of this event table, and end"},
    {"help", nullptr, "print this, and end"},
};

void print_help() {
    std::fputs("usage: puckloop-coordinator [--experiment NAME] [--port DEVICE] [--name value]...\n", stdout);
    std::fputs(help_of(kParameters).c_str(), stdout);
    for (const ExperimentKind& kind : experiments())
        std::printf("experiment %s: %s\n%s", kind.name, kind.help, help_of(kind.parameters()).c_str());
}

/// The file `name` of the results; empty for "none".
std::string result_file(const Parameters& parameters, const std::string& name) {
    const std::string file = parameters.text(name);
    if (file == "none") return {};
    return (std::filesystem::path(parameters.text("out")) / file).string();
}

void save(const std::string& file, const std::string& text) {
    std::ofstream out(file, std::ios::binary);
    out << text;
    if (!out.flush()) throw std::runtime_error(file + ": " + std::strerror(errno));
}

std::string date() {
    const std::time_t now = std::time(nullptr);
    std::tm parts{};
    ::gmtime_r(&now, &parts);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
    return text;
}

Settings settings_of(const Parameters& parameters) {
    Settings settings;
    settings.port = parameters.text("port");
    settings.duration = parameters.number("duration", 0.0, kLongest);
    settings.end_wait = parameters.number("end-wait", 0.0, kLongest);
    settings.discover_every = parameters.number("discover-every", 1.0, kLongest);
    settings.shut_down = parameters.flag("shut-down");
    return settings;
}

int coordinate(const Parameters& parameters, const ExperimentKind& kind) {
    const Settings settings = settings_of(parameters);
    const std::unique_ptr<Experiment> experiment = kind.make(parameters);
    const std::string picture = result_file(parameters, "gantt");
    PosixLine line(settings.port);
    std::filesystem::create_directories(parameters.text("out"));
    EventLog log(result_file(parameters, "events"), !parameters.flag("quiet"));
    Coordinator coordinator(line, *experiment, log, settings, [] { return stop_requested != 0; });
    log.add({0, "", "started", kind.name, date()});
    int status = 0;
    try {
        coordinator.run();
    } catch (const std::runtime_error& error) {
        std::fprintf(stderr, "puckloop-coordinator: %s\n", error.what());
        log.add({coordinator.now(), "", "ended", "failure", error.what()});
        status = kFailed;
    }
    const Module::Counters& c = coordinator.counters();
    std::printf("frames sent %lu, received %lu; faults on the line %lu, bytes %lu\n", c.sent, c.frames,
                c.faults, c.bytes);
    if (!picture.empty()) save(picture, gantt_svg(log.drawn(), kind.name));
    return status;
}

int run(int argc, char** argv) {
    Parameters parameters;
    parameters.read_options({argv + 1, static_cast<std::size_t>(argc - 1)});
    const std::span<const Parameter> general = kParameters;
    if (parameters.given("help")) {
        print_help();
        return 0;
    }
    if (parameters.given("draw")) {
        parameters.declare({general});
        save(result_file(parameters, "gantt"),
             gantt_svg(read_events(parameters.text("draw")), parameters.text("draw")));
        return 0;
    }
    const std::string name = parameters.given("experiment") ? parameters.first("experiment") : "random-task";
    const ExperimentKind* kind = find_experiment(name);
    if (kind == nullptr) parameters.fail("experiment", "'" + name + "' is none", "random-task or sequence");
    parameters.declare({general, kind->parameters()});
    return coordinate(parameters, *kind);
}

}  // namespace

int main(int argc, char** argv) {
    std::setvbuf(stdout, nullptr, _IOLBF, 0);
    catch_signals();
    try {
        return run(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "puckloop-coordinator: %s\n", error.what());
        return kWrongUse;
    }
}
