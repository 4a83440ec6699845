// puckloop-record: drives a robot by a script of wheel commands and keeps what its sensors say, as a CSV
// file. The same program serves on a real robot's Linux board and on an emulated one.
//
// Exit status: 0 the script is through; 1 the PIC could not be reached or the line failed; 2 wrong use.

#include "linuxboard/control/devices/ground_sensor.h"
#include "linuxboard/control/devices/posix_serial.h"
#include "linuxboard/control/option_values.h"
#include "linuxboard/control/session.h"
#include "linuxboard/record/command_script.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <getopt.h>
#include <memory>
#include <string>

namespace {

using namespace puckloop::control;

constexpr double kLeastPeriod = 0.01;  // s: an exchange takes 8 ms on the line
constexpr double kStartWait = 60.0;    // s

const char kUsage[] =
    "usage: puckloop-record --script FILE --log FILE [--period S] [--tty DEVICE] [--i2c DEVICE]\n"
    "                       [--ground-every N] [--relative]\n"
    "  --script FILE   lines: seconds, left, right (steps/s)\n"
    "  --log FILE      CSV, one row per exchange with the PIC\n"
    "  --period S      between two exchanges, at least 0.01 (0.1)\n"
    "  --tty DEVICE    serial line to the PIC, 115200 8N1 (/dev/ttyS0)\n"
    "  --i2c DEVICE    bus of the ground sensors; without the option they are not read\n"
    "  --ground-every N  exchanges from one reading of the ground sensors to the next (1)\n"
    "  --relative      a period counts from the start of the one before, so that what is late adds up\n";

struct Options {
    std::string script, log, tty = "/dev/ttyS0", i2c;
    double period = 0.1;
    long ground_every = 1;
    bool relative = false;
};

Options parse(int argc, char** argv) {
    enum { kScript = 1, kLog, kPeriod, kTty, kI2c, kGroundEvery, kRelative };
    const option table[] = {{"script", required_argument, nullptr, kScript},
                            {"log", required_argument, nullptr, kLog},
                            {"period", required_argument, nullptr, kPeriod},
                            {"tty", required_argument, nullptr, kTty},
                            {"i2c", required_argument, nullptr, kI2c},
                            {"ground-every", required_argument, nullptr, kGroundEvery},
                            {"relative", no_argument, nullptr, kRelative},
                            {"help", no_argument, nullptr, 'h'},
                            {nullptr, 0, nullptr, 0}};
    Options options;
    for (int choice = 0; (choice = ::getopt_long(argc, argv, "h", table, nullptr)) != -1;) {
        switch (choice) {
        case kScript:
            options.script = optarg;
            break;
        case kLog:
            options.log = optarg;
            break;
        case kPeriod:
            options.period = seconds("period", optarg, kLeastPeriod);
            break;
        case kTty:
            options.tty = optarg;
            break;
        case kI2c:
            options.i2c = optarg;
            break;
        case kGroundEvery:
            options.ground_every = whole("ground-every", optarg, 1, 1'000'000);
            break;
        case kRelative:
            options.relative = true;
            break;
        case 'h':
            std::fputs(kUsage, stdout);
            std::exit(0);
        default:
            std::fputs(kUsage, stderr);
            std::exit(kWrongUse);
        }
    }
    if (optind < argc || options.script.empty() || options.log.empty()) {
        std::fputs(kUsage, stderr);
        std::exit(kWrongUse);
    }
    return options;
}

/// One line an exchange; of what was not answered, the time at which it was given up.
class RecordLog {
  public:
    explicit RecordLog(const std::string& path) : file_(std::fopen(path.c_str(), "w")) {
        if (file_ == nullptr) throw std::runtime_error(path + ": cannot be written");
        std::fputs("t_s,cmd_l,cmd_r,t_answer_s,frame_ok,battery_ok", file_);
        for (int i = 0; i < 8; ++i)
            std::fprintf(file_, ",ps%d", i);
        for (int i = 0; i < 8; ++i)
            std::fprintf(file_, ",amb%d", i);
        std::fputs(",gs0,gs1,gs2,acc0,acc1,acc2,mic0,mic1,mic2\n", file_);
    }
    ~RecordLog() { std::fclose(file_); }
    RecordLog(const RecordLog&) = delete;
    RecordLog& operator=(const RecordLog&) = delete;

    void row(double t, const ScriptedCommand& command, double answered,
             const std::optional<puckloop::protocols::EpuckSensors>& s,
             const std::optional<std::array<double, 3>>& ground) {
        std::fprintf(file_, "%.6f,%g,%g,", t, command.left, command.right);
        if (s) {
            std::fprintf(file_, "%.6f,1,%d", answered, static_cast<int>(s->battery_ok));
            for (const auto value : s->proximity)
                std::fprintf(file_, ",%d", static_cast<int>(value));
            for (const auto value : s->light)
                std::fprintf(file_, ",%d", static_cast<int>(value));
        } else {
            std::fprintf(file_, "%.6f,0,,,,,,,,,,,,,,,,,", answered);
        }
        if (ground)
            std::fprintf(file_, ",%g,%g,%g", (*ground)[0], (*ground)[1], (*ground)[2]);
        else
            std::fputs(",,,", file_);
        for (std::size_t i = 0; i < 3; ++i)
            s ? std::fprintf(file_, ",%d", static_cast<int>(s->accelerometer[i])) : std::fputc(',', file_);
        for (std::size_t i = 0; i < 3; ++i)
            s ? std::fprintf(file_, ",%d", static_cast<int>(s->microphones[i])) : std::fputc(',', file_);
        std::fputc('\n', file_);
    }

  private:
    std::FILE* file_;
};

int run(const Options& options) {
    const auto commands = read_command_script(options.script);
    PosixSerial serial(options.tty);
    std::unique_ptr<GroundSensor> ground;
    if (!options.i2c.empty()) ground = std::make_unique<GroundSensor>(options.i2c);
    RecordLog log(options.log);
    Session session(
        serial, [](const std::string& text) { std::printf("%s\n", text.c_str()); }, [] { return false; });
    if (!session.start(serial.now() + kStartWait)) {
        std::fputs("puckloop-record: the PIC does not answer\n", stderr);
        return 1;
    }
    const double begun = serial.now();
    const long last = std::lround(commands.back().seconds / options.period);
    double woken = begun;
    std::size_t next = 0;
    for (long step = 0; step <= last; ++step) {
        const double due = static_cast<double>(step) * options.period;
        if (step > 0) serial.sleep_until(options.relative ? woken + options.period : begun + due);
        woken = serial.now();
        while (next + 1 < commands.size() && commands[next + 1].seconds <= due + options.period / 2)
            ++next;
        puckloop::protocols::EpuckActuators record;
        record.left = static_cast<std::int16_t>(std::lround(commands[next].left));
        record.right = static_cast<std::int16_t>(std::lround(commands[next].right));
        const bool look_down = ground && step % options.ground_every == 0;
        const auto grey = look_down ? ground->read() : std::nullopt;
        const double sent = serial.now();
        const auto answer = session.exchange(record);
        log.row(sent, commands[next], answer ? session.newest_time() : serial.now(), answer, grey);
        if (session.lost() && !session.resync(serial.now() + kStartWait)) return 1;
    }
    session.end();
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    const Options options = parse(argc, argv);
    try {
        return run(options);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "puckloop-record: %s\n", error.what());
        return kWrongUse;
    }
}
