// puckloop-control: the project's own control program for the e-puck's Linux board. It runs on a real robot
// as well as against an emulated one: it knows nothing but a tty and an I2C bus.
//
// Exit status: 0 the session ran its time or was ended by a signal; 1 the PIC could not be reached or the
// line failed; 2 wrong use, or a device that cannot be opened.

#include "linuxboard/control/behaviours/coloured_spots.h"
#include "linuxboard/control/behaviours/machine.h"
#include "linuxboard/control/devices/ground_sensor.h"
#include "linuxboard/control/devices/posix_serial.h"
#include "linuxboard/control/rab_session.h"

#include <csignal>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>

namespace {

using namespace puckloop::control;

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

std::unique_ptr<GroundSensor> open_ground(const Options& options) {
    if (!options.ground) return nullptr;
    if (!options.i2c.empty()) return std::make_unique<GroundSensor>(options.i2c);
    try {
        return std::make_unique<GroundSensor>(kDefaultBus);
    } catch (const std::runtime_error& error) {
        std::printf("no ground sensors: %s\n", error.what());
        return nullptr;
    }
}

/// The board with its threads running; null without it. Throws std::runtime_error if it is required.
std::unique_ptr<RabSession> open_rab(const Options& options, Clock& clock, const RabSession::Log& log) {
    if (!options.rab) return nullptr;
    std::string reason;
    try {
        auto rab = std::make_unique<RabSession>(options, clock, log);
        if (rab->start()) return rab;
        reason = std::string("0x20 does not answer: ") + std::strerror(rab->last_error());
    } catch (const std::runtime_error& error) {
        reason = error.what();
    }
    if (options.rab_required) throw std::runtime_error("no range-and-bearing board: " + reason);
    std::printf("no range-and-bearing board, going on without: %s\n", reason.c_str());
    return nullptr;
}

void report(const SessionCounters& c, const GroundSensor* ground, const RabSession* rab) {
    std::printf("frames sent %lu, records received %lu, longest gap %.3f s\n", c.frames, c.records,
                c.longest_gap);
    std::printf(
        "not answered %lu, short %lu, implausible %lu, slips %lu, stray bytes %lu, re-synchronised %lu\n",
        c.no_answer, c.short_records, c.implausible, c.slips, c.stray_bytes, c.resyncs);
    if (ground != nullptr) std::printf("ground sensor readings failed %lu\n", ground->failures());
    if (rab != nullptr) rab->report();
}

bool interrupted() {
    return stop_requested != 0;
}

/// Prints lines with the time since its making.
RabSession::Log make_log(Clock& clock) {
    return [&clock, begun = clock.now()](const std::string& text) {
        std::printf("[%9.3f s] %s\n", clock.now() - begun, text.c_str());
    };
}

Surroundings surroundings_of(GroundSensor* ground, RabSession* rab, ColouredSpots* spots,
                             const RabSession::Log& log) {
    Surroundings surroundings;
    if (spots != nullptr) surroundings.spots = [spots] { return spots->look(); };
    surroundings.heard = [&log](const InfraredWord& word) {
        constexpr double kDegree = 3.14159265358979 / 180;
        char text[80];
        std::snprintf(text, sizeof text, "infra-red word 0x%02x from %.0f deg, %.1f cm", int{word.data},
                      word.bearing / kDegree, word.range_cm);
        log(text);
    };
    if (ground != nullptr) surroundings.ground = [ground] { return ground->read(); };
    if (rab == nullptr) return surroundings;
    surroundings.neighbours = [rab] { return rab->neighbours(); };
    surroundings.say = [rab](std::uint32_t data) { rab->say(data); };
    return surroundings;
}

int calibrate(const Options& options) {
    PosixClock clock;
    RabSession rab(options, clock, make_log(clock));
    if (!rab.set_up())
        throw std::runtime_error(std::string("no range-and-bearing board: 0x20 does not answer: ") +
                                 std::strerror(rab.last_error()));
    return rab.calibrate(options, interrupted);
}

int drive(const Options& options) {
    PosixSerial serial(options.tty);
    const RabSession::Log log = make_log(serial);
    const std::unique_ptr<GroundSensor> ground = open_ground(options);
    const std::unique_ptr<RabSession> rab = open_rab(options, serial, log);
    const auto spots = options.camera.empty() ? nullptr : std::make_unique<ColouredSpots>(options.camera);
    const std::unique_ptr<Behaviour> behaviour =
        options.behaviour == "machine"
            ? std::make_unique<StateMachine>(options.machine, static_cast<std::uint32_t>(options.rab_id))
            : make_behaviour(options.behaviour, options.rab_id);
    Session session(serial, log, interrupted);
    bool reached = false;
    std::string problem = "the PIC does not answer";
    try {
        reached = run_control_loop(session, serial, *behaviour,
                                   surroundings_of(ground.get(), rab.get(), spots.get(), log), interrupted,
                                   options.loop);
    } catch (const LineError& error) {
        problem = error.what();
    }
    if (interrupted()) log("ended by a signal");
    report(session.counters(), ground.get(), rab.get());
    if (spots)
        std::printf("camera pictures looked at %lu; %lu came in between, which were not needed\n",
                    spots->camera().frames(), spots->camera().unused());
    if (!reached) std::fprintf(stderr, "puckloop-control: %s\n", problem.c_str());
    return reached ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    std::setvbuf(stdout, nullptr, _IOLBF, 0);
    catch_signals();
    const Options options = parse_options(argc, argv);
    try {
        return options.calibrate > 0 ? calibrate(options) : drive(options);
    } catch (const std::runtime_error& error) {
        std::fprintf(stderr, "puckloop-control: %s\n", error.what());
        return kWrongUse;
    }
}
