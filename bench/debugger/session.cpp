#include "bench/debugger/session.h"

#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace puckloop::exec::debugger {

namespace fs = std::filesystem;

void complete_options(DebuggerOptions& options) {
    BenchOptions& bench = options.exec.bench;
    if (bench.mcu.empty() && bench.board.empty()) bench.board = board_for(options.exec.image);
    const TargetDefaults defaults = defaults_of(bench.mcu, bench.board);
    bench.target.chip.crystal_hertz = defaults.crystal_hertz;
    bench.target.chip.fosc = defaults.fosc;
    bench.baud = defaults.baud;
}

Session::Session(const DebuggerOptions& options) {
    ExecOptions exec = options.exec;
    exec.bench.record = true;
    bench_ = std::make_unique<Bench>(exec.bench);
    if (exec.image.empty()) throw InputError("", "IMAGE", "missing", "a HEX, ELF or COFF file");
    const image::Image image =
        bench_->target().read_image(exec.image, defaults_of(exec.bench.mcu, exec.bench.board).mcu);
    const Surroundings around = surround(*bench_, exec);
    if (around.stdio)
        throw InputError("", "--uart1, --uart2", "standard input and output are the debugger's",
                         "pty, tcp:PORT or script:FILE");
    bench_->target().load(image);
    debugged_ = std::make_unique<Debugged>(*bench_);
    std::vector<fs::path> folders(options.sources.begin(), options.sources.end());
    folders.push_back(fs::path(exec.image).parent_path());
    folders.emplace_back(".");
    program_ =
        std::make_unique<Program>(image, bench_->target().lines(), debugged_->chip(), std::move(folders));
    motion_ = std::make_unique<Motion>(*debugged_, *program_);
    debugged_->begin(exec.seconds ? cosim::from_seconds(*exec.seconds) : cosim::kNever, around.live);
}

Session::~Session() = default;

int Session::add_break(const std::string& text, const std::string& current_file, bool once) {
    Point point{Point::Kind::Break, text, {}, {}, {}, once, 0};
    const std::size_t dot = text.find('.'), colon = text.rfind(':');
    const std::string left = text.substr(0, dot);
    std::string upper = left;
    std::transform(upper.begin(), upper.end(), upper.begin(),
                   [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 0x20) : c; });
    if (dot != std::string::npos && colon == std::string::npos && chip().special(upper)) {
        const std::size_t equals = text.find('=');
        const Place place = place_of(std::string_view(text).substr(0, equals), chip(), program());
        point.kind = Point::Kind::Bits;
        point.bits = {place.address, place.bytes, static_cast<std::uint32_t>(place.mask << place.shift), {}};
        if (equals != std::string::npos) {
            std::uint32_t wanted = 0;
            const char* const last = text.data() + text.size();
            const auto [end, error] = std::from_chars(text.data() + equals + 1, last, wanted);
            if (error != std::errc{} || end != last || wanted > place.mask)
                throw InputError("", "",
                                 fmt::format("'{}' is no value of {}", text.substr(equals + 1), place.name),
                                 fmt::format("0 to {}", place.mask));
            point.bits.wanted = wanted << place.shift;
        }
        debugged_->control().add_bits(point.bits);
    } else {
        point.places = program().addresses(text, current_file);
        for (const std::uint32_t pc : point.places) {
            if (!chip().is_code(pc))
                throw InputError("", "", fmt::format("0x{:x} is outside the program memory", pc),
                                 "an address within it");
            motion_->add_break(pc);
        }
    }
    points_[next_] = point;
    return next_++;
}

int Session::add_watch(const std::string& text, const std::string& kind) {
    const Place place = place_of(text, chip(), program());
    if (place.core)
        throw InputError("", "", fmt::format("{} has no address", text),
                         "a variable or register of data space");
    if (place.field) return add_break(text, {}, false);
    Point point{Point::Kind::Watch, text, {}, {}, {}, false, 0};
    point.watch = {place.address, place.bytes,
                   kind == "r"    ? debug::WatchKind::Read
                   : kind == "rw" ? debug::WatchKind::Access
                                  : debug::WatchKind::Write};
    debugged_->control().add_watch(point.watch);
    points_[next_] = point;
    return next_++;
}

bool Session::remove(int number) {
    const auto found = points_.find(number);
    if (found == points_.end()) return false;
    const Point point = found->second;
    points_.erase(found);
    if (point.kind == Point::Kind::Watch) debugged_->control().remove_watch(point.watch);
    if (point.kind == Point::Kind::Bits) debugged_->control().remove_bits(point.bits);
    for (const std::uint32_t pc : point.places) {
        const bool other = std::any_of(points_.begin(), points_.end(), [pc](const auto& entry) {
            return std::find(entry.second.places.begin(), entry.second.places.end(), pc) !=
                   entry.second.places.end();
        });
        if (!other) motion_->remove_break(pc);
    }
    return true;
}

std::vector<int> Session::hit(const debug::Stop& stop) {
    std::vector<int> numbers;
    using Why = debug::Stop::Why;
    for (auto& [number, point] : points_) {
        bool met = false;
        if (point.kind == Point::Kind::Break && (stop.why == Why::Break || stop.why == Why::Step))
            met = std::find(point.places.begin(), point.places.end(), chip().pc()) != point.places.end();
        if (point.kind == Point::Kind::Watch) met = stop.why == Why::Watch && stop.watch == point.watch;
        if (point.kind == Point::Kind::Bits) met = stop.why == Why::Bits && stop.bits == point.bits;
        if (!met) continue;
        ++point.hits;
        numbers.push_back(number);
    }
    for (const int number : numbers)
        if (points_.at(number).once) remove(number);
    return numbers;
}

void Session::finish() {
    bench_->finish();
}

}  // namespace puckloop::exec::debugger
