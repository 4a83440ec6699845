#include "linuxboard/control/options.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <getopt.h>
#include <stdexcept>
#include <unistd.h>

namespace puckloop::control {

namespace {

const char kUsage[] =
    "usage: puckloop-control [--behaviour NAME] [--duration S] [--tty DEVICE] [--i2c DEVICE] [--no-ground]\n"
    "                        [--start-wait S] [--give-up S] [--rab [--rab-required]] [--rab-id N] ...\n"
    "       puckloop-control --rab-calibrate N [--rab-id N] [--duration S] [--i2c DEVICE]\n"
    "  --behaviour NAME   (wander)\n"
    "      wander         straight on, away from obstacles\n"
    "      light          towards the brightest light\n"
    "      aggregate      to the nearest robot heard, and stop beside it\n"
    "      follow         after the robot with the next lower id heard; the lowest leads\n"
    "      seek           looks for a booth that shines green or blue, and serves there; uses /dev/video1\n"
    "                     unless --camera names another\n"
    "      serve          into the booth (TAM) ahead, 8 s inside, out, and again\n"
    "      machine        the finite-state machine of --machine\n"
    "      still          nothing; with --rab somebody to be heard\n"
    "      spin           on the spot, with a short stop every 10.3 s: to measure sensors\n"
    "  --machine TEXT     six behaviours and six conditions as automatic design writes them:\n"
    "                     \"--nstates 2 --s0 0 --rwm0 5 --n0 1 --n0x0 0 --c0x0 0 --p0x0 1 --s1 1 ...\"\n"
    "  -c FILE, -i NAME   taken and not read: programs of ARGoS' real robots are started with them\n"
    "  --duration S       seconds, a step each 0.1 s; 0: until Ctrl-C (0)\n"
    "  --tty DEVICE       serial line to the PIC, 115200 8N1 (/dev/ttyS0)\n"
    "  --i2c DEVICE       bus of the sensor boards; without the option /dev/i2c-3 is used if it is there\n"
    "  --no-ground        do not use the ground sensors\n"
    "  --start-wait S     wait so long for the PIC at the start (60)\n"
    "  --exchanges N      records exchanged with the PIC in each step, 1 to 5 (1): they have no check, and\n"
    "                     with N a garbled speed lasts 0.1 s / N; from 3 on the sensors' medians count\n"
    "  --give-up S        end with status 1 after so long without the PIC in mid-session (60)\n"
    "  --camera DEVICE    the omnidirectional camera, such as /dev/video1: lets serve see which TAM shines\n"
    "  --ircom-send W     send the word W, 0 to 255 or 0x00 to 0xff, by IRcom; seek and serve send it "
    "inside\n"
    "                     a booth only; words that come are printed in any case\n"
    "  --ircom-every S    between two words; 0: in every step (0)\n"
    "range-and-bearing board:\n"
    "  --rab              use it if it is there (aggregate and follow do so anyway)\n"
    "  --rab-required     use it; end with status 2 when it does not answer\n"
    "  --rab-id N         1..255, the robot's own (the number that its host name ends with, 255 for 0);\n"
    "                     it is the lowest byte of what it sends\n"
    "  --rab-bytes N      payload, 1..4 bytes, the same on all robots (2)\n"
    "  --rab-range N      0 farthest, about 1 m, to 255 shortest (115)\n"
    "  --rab-poll-ms N    between two looks for messages (20)\n"
    "  --rab-emit-ms N    between two frames, varied by a tenth (20)\n"
    "  --rab-burst        read a message in one run of registers: half the time on the bus\n"
    "  --rab-gain G       of the distances, from --rab-calibrate (1)\n"
    "  --rab-calibrate N  measure the gain from N messages (100 is usual) of a robot 20 cm away, and end\n";

double milliseconds(const char* option, const char* text) {
    return number(option, text, "milliseconds, 1 to 10000", 1, 10000) / 1e3;
}

std::vector<MachineState> machine(const char* text) {
    try {
        return parse_machine(text);
    } catch (const std::runtime_error& error) {
        std::fprintf(stderr, "puckloop-control: --machine: %s\n", error.what());
        std::exit(kWrongUse);
    }
}

/// It listens to neighbours.
bool machine_needs_neighbours(const std::vector<MachineState>& states) {
    return std::any_of(states.begin(), states.end(), [](const MachineState& state) {
        using Kind = MachineState::Kind;
        const auto counts = [](const MachineCondition& one) {
            return one.kind == MachineCondition::Kind::Neighbours ||
                   one.kind == MachineCondition::Kind::FewNeighbours;
        };
        return state.kind == Kind::Attraction || state.kind == Kind::Repulsion ||
               std::any_of(state.conditions.begin(), state.conditions.end(), counts);
    });
}

/// The number at the end of the board's host name, as fleets of robots are named; 0: none up to 255.
/// Simulators count their robots from 0, which means none here: that one is 255.
int number_of_host() {
    char name[256] = "";
    if (::gethostname(name, sizeof name - 1) != 0) return 0;
    const std::string text(name);
    const std::size_t begin = text.find_last_not_of("0123456789") + 1;  // 0 where there are digits alone
    if (begin == text.size() || text.size() - begin > 3) return 0;
    constexpr int kMost = 255;
    const int number = std::atoi(text.c_str() + begin);
    if (number == 0) return kMost;
    return number <= kMost ? number : 0;
}

enum {
    kBehaviour = 1,
    kDuration,
    kTty,
    kI2c,
    kNoGround,
    kStartWait,
    kGiveUp,
    kExchanges,
    kIrcomSend,
    kIrcomEvery,
    kRab,
    kRabRequired,
    kRabId,
    kRabBytes,
    kRabRange,
    kRabPoll,
    kRabEmit,
    kRabBurst,
    kRabGain,
    kRabCalibrate,
    kCamera,
    kMachine,
};

const option kTable[] = {{"behaviour", required_argument, nullptr, kBehaviour},
                         {"duration", required_argument, nullptr, kDuration},
                         {"tty", required_argument, nullptr, kTty},
                         {"i2c", required_argument, nullptr, kI2c},
                         {"no-ground", no_argument, nullptr, kNoGround},
                         {"start-wait", required_argument, nullptr, kStartWait},
                         {"give-up", required_argument, nullptr, kGiveUp},
                         {"exchanges", required_argument, nullptr, kExchanges},
                         {"ircom-send", required_argument, nullptr, kIrcomSend},
                         {"ircom-every", required_argument, nullptr, kIrcomEvery},
                         {"rab", no_argument, nullptr, kRab},
                         {"rab-required", no_argument, nullptr, kRabRequired},
                         {"rab-id", required_argument, nullptr, kRabId},
                         {"rab-bytes", required_argument, nullptr, kRabBytes},
                         {"rab-range", required_argument, nullptr, kRabRange},
                         {"rab-poll-ms", required_argument, nullptr, kRabPoll},
                         {"rab-emit-ms", required_argument, nullptr, kRabEmit},
                         {"rab-burst", no_argument, nullptr, kRabBurst},
                         {"rab-gain", required_argument, nullptr, kRabGain},
                         {"rab-calibrate", required_argument, nullptr, kRabCalibrate},
                         {"camera", required_argument, nullptr, kCamera},
                         {"machine", required_argument, nullptr, kMachine},
                         {"help", no_argument, nullptr, 'h'},
                         {nullptr, 0, nullptr, 0}};

void take(Options& options, int choice, const char* name) {
    switch (choice) {
    case kBehaviour:
        options.behaviour = optarg;
        break;
    case kDuration:
        options.loop.duration = seconds(name, optarg);
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
        options.loop.start_wait = seconds(name, optarg);
        break;
    case kGiveUp:
        options.loop.give_up = seconds(name, optarg);
        break;
    case kExchanges:
        options.loop.exchanges = whole(name, optarg, 1, kMostExchanges);
        break;
    case kIrcomSend:
        options.loop.word = byte(name, optarg);
        break;
    case kIrcomEvery:
        options.loop.word_every = seconds(name, optarg);
        break;
    case kRab:
        options.rab = true;
        break;
    case kRabRequired:
        options.rab = options.rab_required = true;
        break;
    case kRabId:
        options.rab_id = whole(name, optarg, 1, 255);
        break;
    case kRabBytes:
        options.board.bytes = whole(name, optarg, 1, 4);
        break;
    case kRabRange:
        options.board.range = whole(name, optarg, 0, 255);
        break;
    case kRabPoll:
        options.link.poll_period = milliseconds(name, optarg);
        break;
    case kRabEmit:
        options.link.emit_period = milliseconds(name, optarg);
        break;
    case kRabBurst:
        options.board.burst = true;
        break;
    case kRabGain:
        options.rab_gain = number(name, optarg, "a number above 0", 1e-9, 1e9);
        break;
    case kRabCalibrate:
        options.calibrate = whole(name, optarg, 2, 1000000);
        break;
    case kCamera:
        options.camera = optarg;
        break;
    case kMachine:
        options.machine = machine(optarg);
        options.behaviour = "machine";
        break;
    case 'c':
    case 'i':
        break;
    case 'h':
        std::fputs(kUsage, stdout);
        std::exit(0);
    default:
        std::fputs(kUsage, stderr);
        std::exit(kWrongUse);
    }
}

/// What only shows when all options are known.
void check(Options& options) {
    if (options.behaviour == "machine" && options.machine.empty())
        wrong_value("behaviour", "machine", "--machine TEXT with it");
    if (options.behaviour != "machine" && make_behaviour(options.behaviour) == nullptr)
        wrong_value("behaviour", options.behaviour.c_str(),
                    "wander, light, aggregate, follow, seek, serve, machine, still or spin");
    if (needs_neighbours(options.behaviour) || machine_needs_neighbours(options.machine)) options.rab = true;
    if (needs_camera(options.behaviour) && options.camera.empty()) options.camera = kDefaultCamera;
    if (options.rab && options.rab_id == 0) options.rab_id = number_of_host();
    if (options.rab && options.rab_id == 0 && options.calibrate == 0) {
        std::fprintf(stderr, "puckloop-control: %s needs --rab-id N, 1 to 255, another on each robot\n",
                     needs_neighbours(options.behaviour) || machine_needs_neighbours(options.machine)
                         ? options.behaviour.c_str()
                         : "--rab");
        std::exit(kWrongUse);
    }
    options.link.seed = static_cast<std::uint32_t>(options.rab_id);
}

}  // namespace

Options parse_options(int argc, char** argv) {
    Options options;
    int index = 0;
    for (int choice = 0; (choice = ::getopt_long(argc, argv, "hc:i:", kTable, &index)) != -1;)
        take(options, choice, kTable[index].name);
    if (optind < argc) {
        std::fprintf(stderr, "puckloop-control: unexpected argument %s\n%s", argv[optind], kUsage);
        std::exit(kWrongUse);
    }
    check(options);
    return options;
}

}  // namespace puckloop::control
