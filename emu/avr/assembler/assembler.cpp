#include "emu/avr/assembler/assembler.h"

#include "base/error.h"
#include "base/text/suggest.h"
#include "emu/assembly/source_lines.h"
#include "emu/assembly/text.h"
#include "emu/avr/assembler/encoder.h"
#include "emu/avr/isa/isa.h"

#include <fmt/format.h>

#include <set>

namespace puckloop::avr {

namespace {

using assembly::equal_ignoring_case;
using assembly::is_name;
using assembly::trim;

constexpr std::uint16_t kIoOffset = 0x20, kIoEnd = 0x60;

class Assembler {
  public:
    explicit Assembler(const AssembleOptions& options) : options_(options) {
        value_of_ = [this](std::string_view name) { return find(name); };
        if (!options.device) return;
        for (const RegisterInfo& info : options.device->registers)
            values_[std::string(info.name)] = info.address < kIoEnd ? info.address - kIoOffset : info.address;
    }

    Program run(std::string_view source) {
        const auto lines = assembly::read_source(source, options_.file);
        for (const bool final_pass : {false, true}) {
            final_ = final_pass;
            address_ = 0;
            for (const assembly::SourceLine& line : lines) {
                line_ = &line;
                if (!process(line.text)) break;
            }
        }
        return std::move(program_);
    }

  private:
    [[noreturn]] void fail(std::string_view problem, std::string_view expected = {}) const {
        throw InputError(line_->file, fmt::format("line {}", line_->number), problem, expected);
    }

    std::optional<std::int64_t> find(std::string_view name) const {
        const auto found = values_.find(name);
        if (found != values_.end()) return found->second;
        return std::nullopt;
    }
    std::int64_t value(std::string_view text) const { return evaluate(text, address_, value_of_); }

    void define(std::string_view name, std::int64_t number, bool again_allowed) {
        if (!is_name(name) || name == "." || name == "$") fail(fmt::format("\"{}\" cannot be a name", name));
        if (register_number(name) >= 0)
            fail(fmt::format("\"{}\" is a register's name", name), "another name");
        if (!final_ && !again_allowed && !defined_.insert(std::string(name)).second)
            fail(fmt::format("\"{}\" is defined twice", name), "each label once");
        values_[std::string(name)] = number;
        program_.symbols[std::string(name)] = static_cast<std::uint32_t>(number);
    }

    void emit(std::int64_t byte) {
        if (address_ >= kProgramBytes) fail("the program runs past the 128 KB of program memory");
        if (final_ && !program_.bytes.emplace(address_, static_cast<std::uint8_t>(byte)).second)
            fail(fmt::format("program address 0x{:05X} already holds a byte", address_), "another .org");
        ++address_;
    }
    void emit_word(std::int64_t word) {
        emit(word & 0xFF);
        emit(word >> 8 & 0xFF);
    }

    /// False at .end.
    bool process(std::string_view text) {
        const std::uint32_t start = address_;
        try {
            text = trim(text);
            while (true) {
                const std::size_t colon = text.find(':');
                if (colon == std::string_view::npos || !is_name(trim(text.substr(0, colon)))) break;
                define(trim(text.substr(0, colon)), address_, false);
                text = trim(text.substr(colon + 1));
            }
            if (text.empty()) return true;
            if (const std::size_t equals = text.find('=');
                equals != std::string_view::npos && is_name(trim(text.substr(0, equals)))) {
                define_value(trim(text.substr(0, equals)), text.substr(equals + 1));
                return true;
            }
            if (text[0] == '.' ? !directive(text) : (instruction(text), false)) return false;
            keep(start, text);
            return true;
        } catch (const assembly::ExpressionError& error) {
            fail(error.what(), suggestion(error.what()));
        } catch (const EncodeError& error) {
            fail(error.what(), error.expected);
        }
    }

    void keep(std::uint32_t start, std::string_view text) {
        const bool bytes = address_ > start && program_.bytes.contains(start);  // not a mere .org
        if (final_ && options_.keep_lines && bytes)
            program_.lines.push_back(
                {start, static_cast<int>(address_ - start), line_->number, std::string(text)});
    }

    /// The defined name that an unknown one may mean.
    std::string suggestion(std::string_view problem) const {
        const std::size_t quote = problem.find('"');
        if (!problem.starts_with("unknown name") || quote == std::string_view::npos) return {};
        std::vector<std::string_view> known;
        for (const auto& [symbol, number] : values_)
            known.push_back(symbol);
        const std::string near = nearest_name(problem.substr(quote + 1, problem.size() - quote - 2), known);
        return near.empty() ? "a label or .equ" : near + "?";
    }

    void instruction(std::string_view text) {
        if (address_ & 1)
            fail(fmt::format("an instruction at the odd address 0x{:x}", address_), ".balign 2");
        if (!final_) {
            address_ += 2 * static_cast<std::uint32_t>(size_of(text));
            return;
        }
        const Encoded encoded = encode(text, address_, value_of_);
        for (int i = 0; i < encoded.count; ++i)
            emit_word(encoded.words[static_cast<std::size_t>(i)]);
    }

    void define_value(std::string_view name, std::string_view expression) {
        try {
            define(name, value(expression), true);
        } catch (const assembly::ExpressionError&) {
            if (final_) throw;  // may name a label that comes later
        }
    }

    std::int64_t limited(std::string_view expression, std::int64_t largest) const {
        if (!final_) return 0;
        const std::int64_t number = value(expression);
        if (number > largest || number < -(largest / 2 + 1))
            fail(fmt::format("0x{:x} does not fit", number), fmt::format("up to 0x{:x}", largest));
        return number;
    }

    bool directive(std::string_view text) {
        const std::size_t end = std::min(text.find_first_of(" \t"), text.size());
        const std::string_view name = text.substr(0, end);
        const std::string_view rest = trim(text.substr(end));
        const auto is = [&](std::string_view known) { return equal_ignoring_case(name, known); };
        if (is(".end")) return false;
        if (is(".org")) {
            const std::int64_t target = value(rest);
            if (target < 0 || target >= kProgramBytes)
                fail(fmt::format(".org 0x{:x}", target),
                     fmt::format("a byte address below 0x{:x}", kProgramBytes));
            address_ = static_cast<std::uint32_t>(target);
        } else if (is(".equ") || is(".set")) {
            const auto parts = assembly::split_arguments(rest);
            if (parts.size() != 2)
                fail(fmt::format("{} with {} arguments", name, parts.size()), "a name and a value");
            define_value(parts[0], parts[1]);
        } else if (is(".word")) {
            for (const std::string_view part : assembly::split_arguments(rest))
                emit_word(limited(part, 0xFFFF));
        } else if (is(".byte")) {
            for (const std::string_view part : assembly::split_arguments(rest))
                emit(limited(part, 0xFF));
        } else if (is(".ascii") || is(".asciz")) {
            emit_text(rest);
            if (is(".asciz")) emit(0);
        } else if (is(".balign")) {
            const std::int64_t step = value(rest);
            if (step < 1 || step > 256) fail(fmt::format(".balign {}", step), "1 to 256");
            while (address_ % step != 0)
                emit(0);
        } else if (!is(".text") && !is(".global") && !is(".globl") && !is(".section")) {
            fail(fmt::format("unknown directive \"{}\"", name),
                 ".org .equ .word .byte .ascii .asciz .balign .text .global .include .end");
        }
        return true;
    }

    void emit_text(std::string_view quoted) {
        if (quoted.size() < 2 || quoted.front() != '"' || quoted.back() != '"')
            fail("a text without its quotes");
        quoted = quoted.substr(1, quoted.size() - 2);
        for (std::size_t i = 0; i < quoted.size(); ++i) {
            constexpr std::string_view kCodes = "nrt0\\\"";
            constexpr std::string_view kMeans{"\n\r\t\0\\\"", 6};
            if (quoted[i] != '\\') {
                emit(static_cast<unsigned char>(quoted[i]));
                continue;
            }
            const std::size_t at = ++i < quoted.size() ? kCodes.find(quoted[i]) : std::string_view::npos;
            if (at == std::string_view::npos) fail("unknown escape", "\\n \\r \\t \\0 \\\\ \\\"");
            emit(kMeans[at]);
        }
    }

    const AssembleOptions& options_;
    assembly::SymbolValue value_of_;
    std::map<std::string, std::int64_t, std::less<>> values_;
    std::set<std::string> defined_;
    Program program_;
    const assembly::SourceLine* line_ = nullptr;
    std::uint32_t address_ = 0;
    bool final_ = false;
};

}  // namespace

Program assemble(std::string_view source, const AssembleOptions& options) {
    return Assembler(options).run(source);
}

}  // namespace puckloop::avr
