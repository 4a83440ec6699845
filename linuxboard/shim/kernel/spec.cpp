#include "linuxboard/shim/kernel/spec.h"

#include "base/error.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <set>

namespace puckloop::linuxboard {

namespace {
using nlohmann::json;

constexpr double kPicosecondsPerMicrosecond = 1e6;
constexpr int kLargestFifo = 64;

/// Reads one object, key by key, and refuses the keys nobody asked for.
class Object {
  public:
    Object(const json& value, std::string place) : value_(value), place_(std::move(place)) {
        if (!value_.is_object()) throw InputError("", place_, "is not a JSON object");
    }

    template <typename T>
    void read(const char* key, T& target) {
        if (const json* found = find(key)) {
            try {
                target = found->get<T>();
            } catch (const json::exception&) {
                throw InputError("", where(key), "has the wrong type: " + found->dump());
            }
        }
    }
    void read_seconds(const char* key, cosim::Time& target) {
        double seconds = cosim::to_seconds(target);
        read(key, seconds);
        if (seconds < 0) throw InputError("", where(key), "is negative");
        target = cosim::from_seconds(seconds);
    }
    const json* find(const char* key) {
        seen_.insert(key);
        const auto found = value_.find(key);
        return found == value_.end() ? nullptr : &*found;
    }
    std::string where(const char* key) const { return fmt::format("{}.{}", place_, key); }
    void finish() const {
        for (const auto& [key, unused] : value_.items()) {
            if (!seen_.contains(key)) throw InputError("", where(key.c_str()), "unknown key");
        }
    }

  private:
    const json& value_;
    std::string place_;
    std::set<std::string> seen_;
};

int signal_number(const json& value, const std::string& place) {
    if (value.is_number_integer()) return value.get<int>();
    const std::string text = value.is_string() ? value.get<std::string>() : "";
    for (int number = 1; number < NSIG; ++number) {
        const char* abbreviation = sigabbrev_np(number);
        if (abbreviation != nullptr && (text == abbreviation || text == std::string("SIG") + abbreviation))
            return number;
    }
    throw InputError("", place, "is not a signal", "a name such as \"INT\" or a number");
}

int error_number(const std::string& name, const std::string& place) {
    for (const int number : {EREMOTEIO, ENXIO, EIO, ETIMEDOUT}) {
        if (name == strerrorname_np(number)) return number;
    }
    throw InputError("", place, "is not an error an I2C driver gives", "EREMOTEIO, ENXIO, EIO or ETIMEDOUT");
}

void read_charges(const json& value, const std::string& place, wire::Charges& charges) {
    Object object(value, place);
    const auto read = [&](const char* key, std::int64_t& charge) {
        double microseconds = static_cast<double>(charge) / kPicosecondsPerMicrosecond;
        object.read(key, microseconds);
        if (microseconds < 0.001) throw InputError("", object.where(key), "must be at least 0.001 us");
        charge = static_cast<std::int64_t>(microseconds * kPicosecondsPerMicrosecond);
    };
    read("clock", charges.clock);
    read("device", charges.device);
    read("sync", charges.sync);
    read("thread", charges.thread);
    read("yield", charges.yield);
    object.finish();
}

CameraSpec read_camera(const json& value, const std::string& place) {
    CameraSpec camera;
    Object object(value, place);
    object.read("device", camera.device);
    object.read("card", camera.card);
    object.read("log", camera.log);
    object.read("save", camera.save);
    object.read("save_every", camera.save_every);
    if (camera.save_every < 1) throw InputError("", object.where("save_every"), "must be at least 1");
    object.finish();
    return camera;
}
}  // namespace

LinuxSpec parse_linux_spec(std::string_view text) {
    LinuxSpec spec;
    json value;
    try {
        value = json::parse(text);
    } catch (const json::exception& error) {
        throw InputError("", "linux program", error.what());
    }
    Object object(value, "linux");
    object.read("name", spec.name);
    object.read("program", spec.program);
    object.read("args", spec.args);
    if (const json* env = object.find("env")) {
        if (!env->is_object()) throw InputError("", object.where("env"), "is not an object of strings");
        for (const auto& [key, item] : env->items())
            spec.env.emplace_back(key, item.is_string() ? item.get<std::string>() : item.dump());
    }
    object.read("cwd", spec.cwd);
    object.read("host_name", spec.host_name);
    object.read("tty", spec.tty);
    object.read("fifo_trigger", spec.fifo_trigger);
    if (spec.fifo_trigger < 1 || spec.fifo_trigger > kLargestFifo)
        throw InputError("", object.where("fifo_trigger"), "must be 1 to 64");
    object.read("i2c", spec.i2c);
    if (const json* cameras = object.find("cameras"))
        for (const json& camera : *cameras)
            spec.cameras.push_back(read_camera(camera, object.where("cameras")));
    object.read("i2c_hertz", spec.i2c_hertz);
    if (spec.i2c_hertz <= 0) throw InputError("", object.where("i2c_hertz"), "must be above 0 Hz");
    std::string nack_error = strerrorname_np(spec.i2c_nack_error);
    object.read("i2c_nack_error", nack_error);
    spec.i2c_nack_error = error_number(nack_error, object.where("i2c_nack_error"));
    object.read("clock_ppm", spec.clock_ppm);
    object.read_seconds("tty_batch_s", spec.tty_batch);
    object.read_seconds("i2c_hold_s", spec.i2c_hold);
    double oversleep = cosim::to_seconds(spec.oversleep.mean);  // of either sign
    object.read("oversleep_s", oversleep);
    spec.oversleep.mean = cosim::from_seconds(oversleep);
    object.read_seconds("oversleep_jitter_s", spec.oversleep.jitter);
    object.read("real_time", spec.real_time);
    if (const json* charges = object.find("charges_us"))
        read_charges(*charges, object.where("charges_us"), spec.charges);
    object.read("epoch_s", spec.epoch_s);
    object.read("uptime_s", spec.uptime_s);
    object.read("seed", spec.seed);
    object.read("log", spec.log);
    object.read("echo_output", spec.echo_output);
    object.read("stdin", spec.stdin_file);
    object.read_seconds("start_s", spec.start);
    if (const json* restarts = object.find("restart_at")) {
        for (const json& item : *restarts) {
            Restart restart;
            if (item.is_number()) {
                restart.time = cosim::from_seconds(item.get<double>());
            } else {
                Object entry(item, object.where("restart_at"));
                entry.read_seconds("time_s", restart.time);
                entry.read_seconds("down_s", restart.down);
                entry.finish();
            }
            if (!spec.restarts.empty() &&
                restart.time <= spec.restarts.back().time + spec.restarts.back().down)
                throw InputError("", object.where("restart_at"), "times do not rise");
            spec.restarts.push_back(restart);
        }
    }
    if (const json* signals = object.find("signals")) {
        for (const json& item : *signals) {
            TimedSignal timed;
            Object entry(item, object.where("signals"));
            entry.read_seconds("time_s", timed.time);
            const json* signal = entry.find("signal");
            timed.signal = signal_number(signal != nullptr ? *signal : json(), entry.where("signal"));
            entry.finish();
            if (!spec.signals.empty() && timed.time < spec.signals.back().time)
                throw InputError("", object.where("signals"), "times do not rise");
            spec.signals.push_back(timed);
        }
    }
    if (const json* signal = object.find("end_signal"))
        spec.end_signal = signal_number(*signal, object.where("end_signal"));
    object.read_seconds("grace_s", spec.grace);
    std::vector<double> hangups;
    object.read("hangup_at", hangups);
    for (const double seconds : hangups)
        spec.hangups.push_back(cosim::from_seconds(seconds));
    object.read("exit_ends_run", spec.exit_ends_run);
    object.read("programs", spec.programs);
    object.read("watchdog_s", spec.watchdog_s);
    object.read("shim", spec.shim);
    if (const json* faults = object.find("faults"))
        spec.faults = cosim::faults_from_json(nlohmann::ordered_json::parse(faults->dump()));
    object.finish();
    if (spec.program.empty()) throw InputError("", "linux.program", "no program is given");
    if (spec.host_name.size() >= wire::kNameLength)
        throw InputError("", "linux.host_name", "is longer than 63 characters");
    if (spec.i2c.size() + 1 + spec.cameras.size() > wire::kMaximumDevices)
        throw InputError("", "linux", "too many I2C adapters and cameras");
    return spec;
}

}  // namespace puckloop::linuxboard
