#include "bench/bench_instruments.h"

#include "base/error.h"
#include "base/files/new_file.h"
#include "base/files/partial_file.h"
#include "base/files/text_file.h"
#include "base/text/suggest.h"
#include "emu/image/line_table.h"
#include "emu/image/symbol_sizes.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>

namespace puckloop::exec {

namespace {

std::optional<std::uint32_t> number(std::string_view text) {
    const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
    if (hexadecimal) text.remove_prefix(2);
    std::uint32_t value = 0;
    const char* const last = text.data() + text.size();
    const auto [end, error] = std::from_chars(text.data(), last, value, hexadecimal ? 16 : 10);
    if (text.empty() || error != std::errc{} || end != last) return std::nullopt;
    return value;
}

debug::AddressRange range_of(const std::string& text, const image::Image& image,
                             const debug::Places& places) {
    if (const std::size_t dots = text.find(".."); dots != std::string::npos) {
        const auto first = number(std::string_view(text).substr(0, dots));
        const auto last = number(std::string_view(text).substr(dots + 2));
        if (first && last && *first <= *last) return {*first, *last};
    } else if (const auto start = image.find_code(text)) {
        const auto next = places.functions().upper_bound(*start);
        return {*start, next == places.functions().end() ? 0xFFFFFFFF : next->first - 1};
    }
    throw InputError(image.file, "--trace-range", fmt::format("'{}' is no stretch of the program", text),
                     "a function of the image, or 0xFIRST..0xLAST");
}

/// What is written when the run is over is refused before it begins.
void check_place(const std::string& path) {
    const int descriptor = open_new_file(path, O_APPEND);
    if (descriptor < 0)
        throw InputError(path, "", "cannot be written: " + why_not_written(errno),
                         "a place in a folder that exists and may be written");
    ::close(descriptor);
}

void write_file(const std::string& path, const std::string& text) {
    try {
        puckloop::write_file(path, text);
    } catch (const RunError&) {
        remove_partial(path);
        throw;
    }
}

}  // namespace

/// Ends the run behind an instruction that touches what is watched.
class BenchInstruments::Watches final : public chip::Instrument {
  public:
    Watches(const debug::DebugChip& chip, const debug::Places& places) : chip_(chip), places_(places) {}

    void add(const std::string& text, const image::Image& image) {
        std::string_view rest = text;
        Watch watch{text, 0, 0, false, true};
        if (const std::size_t slash = rest.rfind('/'); slash != std::string_view::npos) {
            const std::string_view kind = rest.substr(slash + 1);
            watch.read = kind.find('r') != std::string_view::npos;
            watch.write = kind.find('w') != std::string_view::npos;
            if (kind != "r" && kind != "w" && kind != "rw") fail(text, image, "/r, /w or /rw at the end");
            rest = rest.substr(0, slash);
        }
        if (const std::size_t colon = rest.rfind(':'); colon != std::string_view::npos) {
            const auto bytes = number(rest.substr(colon + 1));
            if (!bytes || *bytes == 0 || *bytes > 0x10000) fail(text, image, "a number of bytes behind ':'");
            watch.bytes = *bytes;
            rest = rest.substr(0, colon);
        }
        if (!place(watch, rest, image))
            fail(text, image, "a variable of the image, a register, or 0xADDRESS" + near_to(rest, image));
        watches_.push_back(watch);
    }
    const std::string& found() const { return found_; }

    bool instruction(std::uint32_t pc, std::uint64_t) override {
        pc_ = pc;
        return found_.empty();
    }
    void access(std::uint16_t address, int bytes, bool write) override {
        if (!found_.empty()) return;
        for (const Watch& watch : watches_) {
            const bool meets = address + static_cast<std::uint32_t>(bytes) > watch.address &&
                               address < watch.address + watch.bytes;
            if (!meets || !(write ? watch.write : watch.read)) continue;
            found_ = fmt::format("watch {}: {} of 0x{:04x} by 0x{:06x}", watch.text, write ? "write" : "read",
                                 address, pc_);
            if (const std::string place = places_.place(pc_); !place.empty()) found_ += " " + place;
            if (const std::string line = places_.lines().at(pc_); !line.empty()) found_ += " " + line;
            return;
        }
    }

  private:
    struct Watch {
        std::string text;
        std::uint32_t address = 0, bytes = 0;
        bool read = false, write = true;
    };
    bool place(Watch& watch, std::string_view name, const image::Image& image) const {
        std::uint32_t size = 1;
        if (const auto address = number(name); address && *address <= 0xFFFF) {
            watch.address = *address;
        } else if (const auto special = chip_.special(name)) {
            watch.address = special->address;
            size = static_cast<std::uint32_t>(special->bits) / 8;
        } else {
            const auto sizes = image::symbol_sizes(image.file);
            for (const std::string& known : {std::string(name), "_" + std::string(name)}) {
                const auto symbol = image.symbols.find(known);
                if (symbol == image.symbols.end() || symbol->second.space != image::Space::Data) continue;
                watch.address = symbol->second.address;
                if (const auto found = sizes.find(known); found != sizes.end() && found->second > 0)
                    size = found->second;
                if (watch.bytes == 0) watch.bytes = size;
                return true;
            }
            return false;
        }
        if (watch.bytes == 0) watch.bytes = size;
        return true;
    }
    /// Variables of the image that are called nearly so.
    static std::string near_to(std::string_view name, const image::Image& image) {
        std::vector<std::string_view> known;
        for (const auto& [symbol, place] : image.symbols) {
            if (place.space != image::Space::Data) continue;
            const bool of_c = symbol.starts_with("_");  // an underscore that nobody types
            known.push_back(std::string_view(symbol).substr(of_c ? 1 : 0));
        }
        return did_you_mean(name, known);
    }
    [[noreturn]] static void fail(const std::string& text, const image::Image& image,
                                  const std::string& expected) {
        throw InputError(image.file, "--watch", fmt::format("'{}' cannot be watched", text), expected);
    }

    const debug::DebugChip& chip_;
    const debug::Places& places_;
    std::vector<Watch> watches_;
    std::string found_;
    std::uint32_t pc_ = 0;
};

BenchInstruments::BenchInstruments(const InstrumentOptions& options, Target& target,
                                   const image::Image& image)
    : options_(options),
      image_(image.file),
      chip_(target.debug_chip()),
      places_(image.symbols, target.lines()),
      watches_(std::make_unique<Watches>(*chip_, places_)) {
    if (!options.coverage.empty() && places_.lines().empty())
        throw InputError(image.file, "--coverage", "the image has no source lines",
                         "an ELF with debug information (-g)");
    for (const std::string& file : {options.callgrind, options.coverage})
        if (!file.empty()) check_place(file);
    for (const std::string& text : options.watches)
        watches_->add(text, image);
    if (!options.trace.empty()) {
        debug::TraceFilter filter{{}, options.trace_from, options.trace_to};
        for (const std::string& text : options.trace_ranges)
            filter.ranges.push_back(range_of(text, image, places_));
        trace_.emplace(options.trace, *chip_, places_, filter, [&target](std::uint64_t cycle) {
            return cosim::to_seconds(target.clock().time_of(cycle));
        });
    }
    if (options.profiles()) profile_.emplace(*chip_);
    if (options.stats)
        variables_ = {image.symbols, image::symbol_sizes(image.file), chip_->ram_start(), chip_->ram_end(),
                      !chip_->stack_grows_up()};
    // What ends the run is asked first: the others see what is executed, and nothing else.
    if (!options.watches.empty()) instruments_.add(*watches_);
    if (trace_) instruments_.add(*trace_);
    if (profile_) instruments_.add(*profile_);
    chip_->set_instrument(&instruments_, true);
}

BenchInstruments::~BenchInstruments() {
    chip_->set_instrument(nullptr, false);
}

const std::string& BenchInstruments::watched() const {
    return watches_->found();
}

void BenchInstruments::finish() {
    if (trace_) trace_->finish();
    if (!profile_) return;
    profile_->finish(chip_->cycle());
    if (!options_.callgrind.empty())
        write_file(options_.callgrind, callgrind_text(*profile_, places_, image_, *chip_));
    if (!options_.coverage.empty())
        write_file(options_.coverage, lcov_text(*profile_, places_, options_.sources));
}

std::string BenchInstruments::text() const {
    return options_.stats ? profile_text(*profile_, places_, variables_, *chip_) : std::string();
}

std::string BenchInstruments::warning() const {
    return options_.stats ? stack_warning(*profile_, variables_, *chip_) : std::string();
}

std::string BenchInstruments::json() const {
    return options_.stats ? profile_json(*profile_, places_, variables_, *chip_) : std::string();
}

}  // namespace puckloop::exec
