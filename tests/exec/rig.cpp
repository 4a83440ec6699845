#include "tests/exec/rig.h"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <filesystem>

namespace puckloop::exec {

std::optional<std::string> real_image(const std::string& name) {
    const char* const folder = std::getenv("PUCKLOOP_IMAGES");
    if (folder == nullptr) {
        WARN("skipped: PUCKLOOP_IMAGES does not name a folder with the real firmware images");
        return std::nullopt;
    }
    std::string path = std::string(folder) + "/" + name;
    if (!std::filesystem::exists(path)) {
        WARN("skipped: no " + path);
        return std::nullopt;
    }
    return path;
}

Rig::Rig(const std::string& where, const std::string& image_file, pic::Revision revision, double uart2_baud) {
    BenchOptions options;
    const bool board = where == "pic" || where == "rab" || where == "tam";
    (board ? options.board : options.mcu) = where;
    const TargetDefaults defaults = defaults_of(options.mcu, options.board);
    options.target.chip.crystal_hertz = defaults.crystal_hertz;
    options.target.chip.fosc = defaults.fosc;
    options.target.revision = revision;
    if (revision == pic::Revision::Rev13) options.target.i2c_devices = exec::parse_i2c_devices({"lsm330"});
    baud_ = defaults.baud[0];
    options.baud = defaults.baud;
    if (uart2_baud > 0) options.baud[1] = uart2_baud;
    bench_ = std::make_unique<Bench>(options);
    bench_->on_change = [this](std::string_view pin, std::string_view signal, double value,
                               cosim::Time time) {
        changes_.push_back({std::string(signal.empty() ? pin : signal), value, cosim::to_seconds(time)});
    };
    for (int unit = 1; unit <= 2; ++unit) {
        auto end = std::make_unique<ScriptEnd>();
        ends_[static_cast<std::size_t>(unit - 1)] = end.get();
        bench_->uart(unit).attach(std::move(end));
    }
    bench_->target().load(image::load_image(image_file));
}

void Rig::set(const std::string& signal, double value) {
    const auto id = cosim::find_signal(bench_->target().signals(), signal);
    REQUIRE(id.has_value());
    bench_->target().set_signal(*id, value);
}

double Rig::get(const std::string& signal) {
    const auto id = cosim::find_signal(bench_->target().signals(), signal);
    REQUIRE(id.has_value());
    return bench_->target().signal(*id);
}

double Rig::send(int unit, const std::vector<std::uint8_t>& bytes) {
    const double byte_s = 10.0 / baud_;
    ends_[static_cast<std::size_t>(unit - 1)]->send(bench_->now(), bytes);
    return now_s() + static_cast<double>(bytes.size()) * byte_s;
}

std::vector<ScriptEnd::Heard> Rig::take(int unit) {
    const auto index = static_cast<std::size_t>(unit - 1);
    const auto& all = ends_[index]->received();
    std::vector<ScriptEnd::Heard> fresh(all.begin() + static_cast<std::ptrdiff_t>(taken_[index]), all.end());
    taken_[index] = all.size();
    return fresh;
}

std::vector<std::uint8_t> Rig::take_bytes(int unit) {
    std::vector<std::uint8_t> bytes;
    for (const ScriptEnd::Heard& heard : take(unit))
        bytes.push_back(heard.byte);
    return bytes;
}

std::string Rig::take_text(int unit) {
    std::string text;
    for (const std::uint8_t byte : take_bytes(unit))
        text += static_cast<char>(byte);
    return text;
}

std::vector<Rig::Change> Rig::changes(const std::string& name) const {
    std::vector<Change> found;
    for (const Change& change : changes_)
        if (change.name == name) found.push_back(change);
    return found;
}

}  // namespace puckloop::exec
