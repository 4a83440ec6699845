// What each command of the console does.

#include "base/error.h"
#include "bench/debugger/console.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdio>

namespace puckloop::exec::debugger {

using debug::Stop;

namespace {

constexpr std::size_t kMostFrames = 64;
constexpr std::uint32_t kListed = 10;  // lines
constexpr int kDisassembled = 10;      // instructions from an address
constexpr int kMostDisassembled = 1000;
constexpr std::uint32_t kMostMemory = 4096;

const std::string& needed_word(const std::vector<std::string>& words, const char* what) {
    if (words.size() < 2) throw InputError("", words[0], fmt::format("{} is missing", what), "see help");
    return words[1];
}

/// Words from `first` on as one.
std::string joined(const std::vector<std::string>& words, std::size_t first) {
    std::string text;
    for (std::size_t i = first; i < words.size(); ++i)
        text += words[i];
    return text;
}

std::size_t times(const std::vector<std::string>& words) {
    constexpr std::size_t kMost = 1000000;
    if (words.size() < 2) return 1;
    std::size_t count = 0;
    const char* const last = words[1].data() + words[1].size();
    const auto [end, error] = std::from_chars(words[1].data(), last, count);
    if (error != std::errc{} || end != last || count == 0 || count > kMost)
        throw InputError("", words[0], fmt::format("'{}' is no number of times", words[1]), "1 to 1000000");
    return count;
}

}  // namespace

std::vector<Frame> Console::frames(std::size_t most) {
    return backtrace(session_.chip(), session_.program(), most);
}

std::string Console::current_file() const {
    if (!listed_.file.empty()) return listed_.file;
    return session_.program().line_of(session_.chip().pc()).file;
}

void Console::show_place() {
    const std::uint32_t pc = session_.chip().pc();
    frame_ = 0;
    std::printf("%s\n", session_.program().where(pc).c_str());
    listed_ = session_.program().line_of(pc);
    const auto& text = session_.program().source(listed_.file);
    if (listed_.line > 0 && listed_.line <= text.size())
        std::printf("%u\t%s\n", listed_.line, text[listed_.line - 1].c_str());
    else if (listed_.line == 0 || text.empty())
        std::printf("=> %s\n", session_.chip().instruction(pc).text.c_str());
    for (const std::string& name : displays_)
        std::printf("%s = %s\n", name.c_str(),
                    shown(place_of(name, session_.chip(), session_.program()), session_.chip(), 0).c_str());
}

void Console::stopped(const Stop& stop) {
    const std::vector<int> hits = session_.hit(stop);
    for (const int number : hits) {
        const auto found = session_.points().find(number);  // gone if it stops once
        std::printf("%s %d%s\n", stop.why == Stop::Why::Watch ? "watchpoint" : "breakpoint", number,
                    found == session_.points().end() ? "" : (": " + found->second.text).c_str());
        if (stop.why == Stop::Why::Watch || stop.why == Stop::Why::Bits)
            if (found != session_.points().end()) {
                const std::string text = found->second.text.substr(0, found->second.text.find('='));
                std::printf(
                    "%s = %s\n", text.c_str(),
                    shown(place_of(text, session_.chip(), session_.program()), session_.chip(), 0).c_str());
            }
    }
    switch (stop.why) {
    case Stop::Why::Interrupt:
        std::printf("interrupted\n");
        break;
    case Stop::Why::Begin:
        std::printf("this is the beginning: there is nothing before\n");
        break;
    case Stop::Why::End:
        std::printf("the run is over\n");
        session_.end();
        break;
    default:
        break;
    }
    show_place();
}

void Console::move(const Words& words, const std::function<Stop()>& once) {
    const auto act = find(words[0])->act;
    const bool backward = act == &Console::back || act == &Console::back_into ||
                          act == &Console::back_instruction || act == &Console::reverse_continue;
    if (session_.over() && !backward)
        throw InputError("", words[0], "the run is over", "a way back, or quit");
    session_.revive();
    interrupted_();  // Ctrl-C at the prompt is none of the program's
    const std::size_t count = times(words);
    last_ = words[0];
    Stop stop;
    for (std::size_t i = 0; i < count; ++i) {
        stop = once();
        const bool goes_on =
            stop.why == Stop::Why::Step || (act == &Console::run && i + 1 < count &&
                                            stop.why != Stop::Why::End && stop.why != Stop::Why::Interrupt);
        if (!goes_on) break;
    }
    stopped(stop);
}

void Console::added(int number) {
    const Point& point = session_.points().at(number);
    std::string text = fmt::format(
        "{} {}: {}", point.kind == Point::Kind::Watch ? "watchpoint" : "breakpoint", number, point.text);
    for (const std::uint32_t pc : point.places)
        text += (pc == point.places.front() ? " at " : ", ") + session_.program().where(pc);
    if (point.kind == Point::Kind::Watch)
        text += fmt::format(" at 0x{:04x}, {} byte{}", point.watch.start, point.watch.bytes,
                            point.watch.bytes == 1 ? "" : "s");
    std::printf("%s\n", text.c_str());
}

void Console::break_(const Words& words) {
    if (words.size() < 2) {  // here
        added(session_.add_break(fmt::format("0x{:x}", session_.chip().pc()), {}, false));
        return;
    }
    added(session_.add_break(joined(words, 1), current_file(), false));
}

void Console::tbreak(const Words& words) {
    static_cast<void>(needed_word(words, "a place"));
    added(session_.add_break(joined(words, 1), current_file(), true));
}

void Console::watch(const Words& words) {
    const std::string kind = words.size() > 2 ? words[2] : "w";
    if (kind != "r" && kind != "w" && kind != "rw")
        throw InputError("", "watch", fmt::format("'{}' is no kind of access", kind), "r, w or rw");
    added(session_.add_watch(needed_word(words, "what to watch"), kind));
}

void Console::delete_(const Words& words) {
    if (words.size() < 2) {
        while (!session_.points().empty())
            session_.remove(session_.points().begin()->first);
        return;
    }
    for (std::size_t i = 1; i < words.size(); ++i) {
        int number = 0;
        const char* const last = words[i].data() + words[i].size();
        const auto [end, error] = std::from_chars(words[i].data(), last, number);
        if (error != std::errc{} || end != last || !session_.remove(number))
            throw InputError("", "delete", fmt::format("no break- or watchpoint '{}'", words[i]),
                             "a number of `info`");
    }
}

void Console::info(const Words& words) {
    if (words.size() > 1 && std::string_view("registers").starts_with(words[1])) return registers(words);
    if (session_.points().empty()) std::printf("no break- or watchpoints\n");
    for (const auto& [number, point] : session_.points())
        std::printf("%d  %s %s%s, %zu hit%s\n", number, point.kind == Point::Kind::Watch ? "watch" : "break",
                    point.text.c_str(), point.once ? ", once" : "", point.hits, point.hits == 1 ? "" : "s");
    std::printf("%s, %zu functions, %zu variables%s\n", session_.program().file().c_str(),
                session_.program().function_names().size(), session_.program().variable_names().size(),
                session_.program().has_lines() ? "" : ", no source lines");
}

void Console::run(const Words& words) {
    move(words, [this] { return session_.motion().run(); });
}
void Console::step(const Words& words) {
    move(words, [this] { return session_.motion().step_line(true); });
}
void Console::next(const Words& words) {
    move(words, [this] { return session_.motion().step_line(false); });
}
void Console::stepi(const Words& words) {
    move(words, [this] { return session_.motion().step_instruction(); });
}
void Console::nexti(const Words& words) {
    move(words, [this] { return session_.motion().next_instruction(); });
}
void Console::finish(const Words& words) {
    const std::size_t frame = frame_;
    move({words[0]}, [this, frame] {
        const Stop stop = session_.motion().finish(frame + 1);
        if (stop.why == Stop::Why::Begin)
            throw InputError("", "finish", "no caller is known of this function", "");
        return stop;
    });
}
void Console::until(const Words& words) {
    const auto places = session_.program().addresses(needed_word(words, "a place"), current_file());
    move({words[0]}, [this, &places] { return session_.motion().run_to(places.front()); });
    last_.clear();
}
void Console::back(const Words& words) {
    move(words, [this] { return session_.motion().back_line(false); });
}
void Console::back_into(const Words& words) {
    move(words, [this] { return session_.motion().back_line(true); });
}
void Console::back_instruction(const Words& words) {
    move(words, [this] { return session_.motion().back_instruction(); });
}
void Console::reverse_continue(const Words& words) {
    move(words, [this] { return session_.motion().back_run(); });
}

void Console::backtrace_(const Words&) {
    const auto all = frames(kMostFrames);
    for (std::size_t i = 0; i < all.size(); ++i)
        std::printf("%s#%zu  %s%s\n", i == frame_ ? "*" : " ", i,
                    session_.program().where(all[i].pc, all[i].line_pc).c_str(),
                    all[i].interrupt ? ", of an interrupt" : "");
}

void Console::choose_frame(std::size_t frame) {
    const auto all = frames(kMostFrames);
    if (frame >= all.size()) throw InputError("", "", "there is no frame further up", "");
    frame_ = frame;
    std::printf("#%zu  %s\n", frame, session_.program().where(all[frame].pc, all[frame].line_pc).c_str());
    listed_ = session_.program().line_of(all[frame].line_pc);
    const auto& text = session_.program().source(listed_.file);
    if (listed_.line > 0 && listed_.line <= text.size())
        std::printf("%u\t%s\n", listed_.line, text[listed_.line - 1].c_str());
}

void Console::up(const Words& words) {
    choose_frame(frame_ + times(words));
}

void Console::down(const Words& words) {
    if (times(words) > frame_) throw InputError("", "down", "there is no frame further down", "");
    choose_frame(frame_ - times(words));
}

void Console::list_around(const SourceLine& line) {
    const auto& text = session_.program().source(line.file);
    if (line.file.empty())
        throw InputError("", "list", "no source line is known here", "FILE:LINE or a function");
    if (text.empty())
        throw InputError(line.file, "", "is in none of the folders with sources", "--sources DIR");
    if (line.line > text.size())
        throw InputError(line.file, "", fmt::format("has {} lines", text.size()), "");
    const auto current = session_.program().line_of(session_.chip().pc());
    const std::uint32_t end =
        std::min<std::uint32_t>(line.line + kListed, static_cast<std::uint32_t>(text.size()) + 1);
    for (std::uint32_t i = std::max(line.line, 1u); i < end; ++i)
        std::printf("%s%u\t%s\n", current.file == line.file && current.line == i ? "=>" : "  ", i,
                    text[i - 1].c_str());
    listed_ = {line.file, end};
}

void Console::list(const Words& words) {
    SourceLine line = listed_;
    if (words.size() > 1) {
        line = session_.program().line_of(session_.program().addresses(words[1], current_file()).front());
        line.line = line.line > kListed / 2 ? line.line - kListed / 2 : 1;
    } else if (const auto here = session_.program().line_of(session_.chip().pc()); here == listed_) {
        line.line = line.line > kListed / 2 ? line.line - kListed / 2 : 1;
    }
    list_around(line);
    last_ = words[0];
}

void Console::disassemble(const Words& words) {
    const debug::DebugChip& chip = session_.chip();
    const Program& program = session_.program();
    // x/N, x/Ni: so many instructions from the place on, as gdb has it.
    std::size_t first = 1;
    int count = kDisassembled;
    if (words.size() > 1 && words[1].starts_with("/")) {
        std::string_view number = std::string_view(words[1]).substr(1);
        if (number.ends_with("i")) number.remove_suffix(1);
        const char* const last = number.data() + number.size();
        if (const auto [end, error] = std::from_chars(number.data(), last, count);
            error != std::errc{} || end != last || count < 1 || count > kMostDisassembled)
            throw InputError("", "disassemble", fmt::format("'{}' is no count", words[1]),
                             fmt::format("/1 to /{}; print or memory show data", kMostDisassembled));
        first = 2;
    }
    const bool address = first == 2 || (words.size() > 1 && words[1].starts_with("0x"));
    const std::uint32_t place =
        words.size() > first ? program.addresses(words[first], current_file()).front() : chip.pc();
    const std::uint32_t function = program.function_of(place);
    const bool whole = !address && !program.function_name(place).empty();
    std::uint32_t pc = whole ? function : place;
    SourceLine shown_line;
    for (int i = 0; chip.is_code(pc) &&
                    (whole ? program.function_of(pc) == function && i < kMostDisassembled : i < count);
         ++i) {
        const debug::Instruction instruction = chip.instruction(pc);
        const SourceLine line = program.line_of(pc);
        if (line != shown_line && line.line != 0) std::printf("%s:%u\n", line.file.c_str(), line.line);
        shown_line = line;
        std::printf("%s 0x%06x %-16s %s\n", pc == chip.pc() ? "=>" : "  ", pc, program.place(pc).c_str(),
                    instruction.text.c_str());
        pc += instruction.size;
    }
}

void Console::print(const Words& words) {
    char format = 0;
    std::size_t first = 1;
    if (words.size() > 1 && words[1].starts_with("/")) {
        format = words[1].size() == 2 ? words[1][1] : '?';
        if (std::string_view("xdust").find(format) == std::string_view::npos)
            throw InputError("", "print", fmt::format("'{}' is no format", words[1]), "/x, /d, /u, /s or /t");
        first = 2;
    }
    if (words.size() <= first)
        throw InputError("", "print", "what to print is missing", "a variable or register");
    for (std::size_t i = first; i < words.size(); ++i)
        std::printf(
            "%s = %s\n", words[i].c_str(),
            shown(place_of(words[i], session_.chip(), session_.program()), session_.chip(), format).c_str());
}

void Console::display(const Words& words) {
    if (words.size() < 2) {
        displays_.clear();
        return;
    }
    const Place place = place_of(words[1], session_.chip(), session_.program());
    displays_.push_back(words[1]);
    std::printf("%s = %s\n", words[1].c_str(), shown(place, session_.chip(), 0).c_str());
}

void Console::set(const Words& words) {
    const std::string text = joined(words, 1);
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos)
        throw InputError("", "set", fmt::format("'{}' assigns nothing", text), "WHAT = NUMBER");
    const Place place =
        place_of(std::string_view(text).substr(0, equals), session_.chip(), session_.program());
    std::string_view number = std::string_view(text).substr(equals + 1);
    const bool negative = number.starts_with("-");
    if (negative) number.remove_prefix(1);
    const bool hexadecimal = number.starts_with("0x");
    if (hexadecimal) number.remove_prefix(2);
    std::uint64_t value = 0;
    const char* const last = number.data() + number.size();
    const auto [end, error] = std::from_chars(number.data(), last, value, hexadecimal ? 16 : 10);
    if (number.empty() || error != std::errc{} || end != last)
        throw InputError("", "set", fmt::format("'{}' is no number", text.substr(equals + 1)),
                         "such as 12, -1 or 0x1f");
    if (negative) value = 0 - value;
    const std::uint64_t most = place.field        ? place.mask
                               : place.bytes >= 8 ? ~0ull
                                                  : (1ull << 8 * place.bytes) - 1;
    if (!negative && value > most)
        throw InputError("", "set",
                         fmt::format("{} does not fit into {}", text.substr(equals + 1), place.name),
                         fmt::format("at most {}", most));
    if (const std::string why = session_.debugged().frozen(); !why.empty())
        throw InputError("", "set", why, "");
    if (!session_.debugged().change(
            [&place, value](debug::DebugChip& chip) { return write(place, chip, value); }))
        throw InputError("", "set", fmt::format("{} cannot be written", place.name), "");
    std::printf("%s = %s\n", place.name.c_str(), shown(place, session_.chip(), 0).c_str());
}

void Console::memory(const Words& words) {
    Place place = place_of(needed_word(words, "an address"), session_.chip(), session_.program());
    if (place.core || place.field)
        throw InputError("", "memory", fmt::format("{} has no address", words[1]), "a variable or 0xADDRESS");
    std::uint32_t bytes = std::max(place.bytes, 16u);
    if (words.size() > 2) {
        const char* const last = words[2].data() + words[2].size();
        const auto [end, error] = std::from_chars(words[2].data(), last, bytes);
        if (error != std::errc{} || end != last || bytes == 0 || bytes > kMostMemory)
            throw InputError("", "memory", fmt::format("'{}' is no number of bytes", words[2]),
                             fmt::format("1 to {}", kMostMemory));
    }
    constexpr std::uint32_t kRow = 16;
    for (std::uint32_t at = 0; at < bytes; at += kRow) {
        std::vector<std::uint8_t> row(std::min(kRow, bytes - at));
        const std::uint32_t address = place.address + at;
        if (address > 0xFFFF ||
            !session_.chip().read_memory(
                debug::DebugChip::address_of_data(static_cast<std::uint16_t>(address)), row)) {
            std::printf("0x%04x  no such memory\n", address);
            return;
        }
        std::string text = fmt::format("0x{:04x} ", address);
        for (const std::uint8_t byte : row)
            text += fmt::format(" {:02x}", byte);
        std::printf("%s\n", text.c_str());
    }
}

void Console::registers(const Words&) {
    const auto list = session_.chip().registers();
    std::vector<std::uint64_t> values(list.size());
    session_.chip().read_registers(values);
    std::string line;
    for (std::size_t i = 0; i < list.size(); ++i) {
        const std::string one = fmt::format(
            "{}=0x{:0{}x}", list[i].name,
            values[i] & (list[i].bits >= 64 ? ~0ull : (1ull << list[i].bits) - 1), list[i].bits / 4);
        if (line.size() + one.size() > 78) {
            std::printf("%s\n", line.c_str());
            line.clear();
        }
        line += (line.empty() ? "" : " ") + one;
    }
    std::printf("%s\n", line.c_str());
}

void Console::interrupts_(const Words&) {
    std::printf("%s", interrupts(session_.chip()).c_str());
}

void Console::time(const Words&) {
    std::printf("%.9f s, %llu cycles, %llu instructions%s\n", session_.debugged().seconds(),
                static_cast<unsigned long long>(session_.chip().cycle()),
                static_cast<unsigned long long>(session_.chip().instructions()),
                session_.debugged().in_past() ? ", in the past" : "");
}

void Console::reset(const Words&) {
    if (const std::string why = session_.debugged().frozen(); !why.empty())
        throw InputError("", "reset", why, "");
    session_.debugged().press_reset();
    show_place();
}

void Console::help(const Words& words) {
    const Command* only = words.size() > 1 ? find(words[1]) : nullptr;
    if (words.size() > 1 && only == nullptr)
        throw InputError("", "help", fmt::format("no command '{}'", words[1]), "help alone");
    for (const Command& command : commands()) {
        if (only != nullptr && only != &command) continue;
        std::printf("  %-34s %s\n",
                    fmt::format("{}{}{} {}", command.name, *command.other ? ", " : "", command.other,
                                command.arguments)
                        .c_str(),
                    command.about);
    }
}

void Console::quit(const Words&) {
    over_ = true;
}

}  // namespace puckloop::exec::debugger
