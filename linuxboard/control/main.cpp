// puckloop-control: the project's own control program for the e-puck's Linux board. It runs on a real robot
// as well as against an emulated one: it knows nothing but a tty and an I2C bus.
//
// Exit status: 0 the session ran its time or was ended by a signal; 1 the PIC could not be reached or the
// line failed; 2 wrong use, or a device that cannot be opened.

#include "linuxboard/control/control_loop.h"
#include "linuxboard/control/ground_sensor.h"
#include "linuxboard/control/posix_serial.h"

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <getopt.h>
#include <memory>
#include <string>

namespace {

using namespace puckloop::control;

constexpr int kWrongUse = 2;
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

const char kUsage[] =
    "usage: puckloop-control [--behaviour wander|light] [--duration S] [--tty DEVICE]\n"
    "                        [--i2c DEVICE | --no-ground] [--start-wait S] [--give-up S]\n"
    "  --behaviour NAME  wander: straight on, away from obstacles; light: towards the brightest light "
    "(wander)\n"
    "  --duration S      seconds, a step each 0.1 s; 0: until Ctrl-C (0)\n"
    "  --tty DEVICE      serial line to the PIC, 115200 8N1 (/dev/ttyS0)\n"
    "  --i2c DEVICE      bus of the ground sensors; without the option /dev/i2c-3 is used if it is there\n"
    "  --no-ground       do not touch the I2C bus\n"
    "  --start-wait S    wait so long for the PIC at the start (60)\n"
    "  --give-up S       end with status 1 after so long without the PIC in mid-session (60)\n";

struct Options {
    std::string behaviour = "wander";
    std::string tty = "/dev/ttyS0";
    std::string i2c;
    bool ground = true;
    LoopSettings loop;
};

/// A number of seconds, not negative; anything else ends the program.
double seconds(const char* option, const char* text) {
    char* end = nullptr;
    const double value = std::strtod(text, &end);
    if (end == text || *end != '\0' || !(value >= 0) || value > 1e9) {
        std::fprintf(stderr, "puckloop-control: --%s %s: expected a number of seconds\n", option, text);
        std::exit(kWrongUse);
    }
    return value;
}

Options parse(int argc, char** argv) {
    enum { kBehaviour = 1, kDuration, kTty, kI2c, kNoGround, kStartWait, kGiveUp };
    const option table[] = {{"behaviour", required_argument, nullptr, kBehaviour},
                            {"duration", required_argument, nullptr, kDuration},
                            {"tty", required_argument, nullptr, kTty},
                            {"i2c", required_argument, nullptr, kI2c},
                            {"no-ground", no_argument, nullptr, kNoGround},
                            {"start-wait", required_argument, nullptr, kStartWait},
                            {"give-up", required_argument, nullptr, kGiveUp},
                            {"help", no_argument, nullptr, 'h'},
                            {nullptr, 0, nullptr, 0}};
    Options options;
    for (int choice = 0; (choice = ::getopt_long(argc, argv, "h", table, nullptr)) != -1;) {
        switch (choice) {
        case kBehaviour:
            options.behaviour = optarg;
            break;
        case kDuration:
            options.loop.duration = seconds("duration", optarg);
            break;
        case kTty:
            options.tty = optarg;
            break;
        case kI2c:
            options.i2c = optarg;
            break;
        case kNoGround:
            options.ground = false;
            break;
        case kStartWait:
            options.loop.start_wait = seconds("start-wait", optarg);
            break;
        case kGiveUp:
            options.loop.give_up = seconds("give-up", optarg);
            break;
        case 'h':
            std::fputs(kUsage, stdout);
            std::exit(0);
        default:
            std::fputs(kUsage, stderr);
            std::exit(kWrongUse);
        }
    }
    if (optind < argc) {
        std::fprintf(stderr, "puckloop-control: unexpected argument %s\n%s", argv[optind], kUsage);
        std::exit(kWrongUse);
    }
    return options;
}

std::unique_ptr<GroundSensor> open_ground(const Options& options) {
    if (!options.ground) return nullptr;
    if (!options.i2c.empty()) return std::make_unique<GroundSensor>(options.i2c);
    try {
        return std::make_unique<GroundSensor>("/dev/i2c-3");
    } catch (const std::runtime_error& error) {
        std::printf("no ground sensors: %s\n", error.what());
        return nullptr;
    }
}

void report(const SessionCounters& c, const GroundSensor* ground) {
    std::printf("frames sent %lu, records received %lu, longest gap %.3f s\n", c.frames, c.records,
                c.longest_gap);
    std::printf(
        "not answered %lu, short %lu, implausible %lu, slips %lu, stray bytes %lu, re-synchronised %lu\n",
        c.no_answer, c.short_records, c.implausible, c.slips, c.stray_bytes, c.resyncs);
    if (ground != nullptr) std::printf("ground sensor readings failed %lu\n", ground->failures());
}

int run(const Options& options) {
    const std::unique_ptr<Behaviour> behaviour = make_behaviour(options.behaviour);
    if (!behaviour) {
        std::fprintf(stderr, "puckloop-control: --behaviour %s: expected wander or light\n",
                     options.behaviour.c_str());
        return kWrongUse;
    }
    std::unique_ptr<PosixSerial> serial;
    std::unique_ptr<GroundSensor> ground;
    try {
        serial = std::make_unique<PosixSerial>(options.tty);
        ground = open_ground(options);
    } catch (const std::runtime_error& error) {
        std::fprintf(stderr, "puckloop-control: %s\n", error.what());
        return kWrongUse;
    }
    const double begun = serial->now();
    const auto log = [&](const std::string& text) {
        std::printf("[%9.3f s] %s\n", serial->now() - begun, text.c_str());
    };
    const auto interrupted = [] { return stop_requested != 0; };
    const auto read_ground = [&]() -> std::optional<std::array<double, 3>> {
        return ground ? ground->read() : std::nullopt;
    };
    Session session(*serial, log, interrupted);
    bool reached = false;
    try {
        reached = run_control_loop(session, *serial, *behaviour, read_ground, interrupted, options.loop);
    } catch (const LineError& error) {
        std::fprintf(stderr, "puckloop-control: %s\n", error.what());
    }
    if (interrupted()) log("ended by a signal");
    report(session.counters(), ground.get());
    if (!reached) std::fprintf(stderr, "puckloop-control: the PIC does not answer\n");
    return reached ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    std::setvbuf(stdout, nullptr, _IOLBF, 0);
    catch_signals();
    return run(parse(argc, argv));
}
