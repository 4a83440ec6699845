#include "emu/dspic/assembler/assembler.h"

#include "base/error.h"
#include "base/text/suggest.h"
#include "emu/assembly/source_lines.h"
#include "emu/dspic/assembler/encoder.h"

#include <fmt/format.h>

#include <optional>
#include <set>

namespace puckloop::dspic {

namespace {

using assembly::is_name;
using assembly::read_source;
using assembly::SourceLine;
using assembly::split_arguments;

constexpr std::uint32_t kAddressEnd = 0x1000000;
constexpr std::int64_t kLargestWord = 0xFFFFFF;
constexpr std::size_t kMostWords = 1u << 20;  // five times the largest dsPIC

class Assembler {
  public:
    explicit Assembler(const AssembleOptions& options) : options_(options) {
        for (const auto& [name, value] : options.predefined)
            values_[name] = value;
        value_of_ = [this](std::string_view name) { return find(name); };
    }

    Program run(std::string_view source) {
        const std::vector<SourceLine> lines = read_source(source, options_.file);
        for (const bool final_pass : {false, true}) {
            final_ = final_pass;
            address_ = options_.origin;
            for (const SourceLine& line : lines) {
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

    std::int64_t value(std::string_view expression) const {
        return evaluate(expression, address_, value_of_);
    }

    void define(std::string_view name, std::int64_t number, bool again_allowed) {
        if (!is_name(name) || name == "." || name == "$") fail(fmt::format("\"{}\" cannot be a name", name));
        if (is_reserved_name(name)) fail(fmt::format("\"{}\" is a register's name", name), "another name");
        if (!final_ && !again_allowed && !defined_.insert(std::string(name)).second)
            fail(fmt::format("\"{}\" is defined twice", name), "each label once");
        values_[std::string(name)] = number;
        program_.symbols[std::string(name)] = static_cast<std::uint32_t>(number);
    }

    void emit(std::uint32_t word) {
        if (address_ >= kAddressEnd) fail("the program runs past the 24-bit program space");
        if (final_ && !program_.words.emplace(address_, word).second)
            fail(fmt::format("program address 0x{:06X} already holds a word", address_), "another .org");
        if (final_ && program_.words.size() > kMostWords) fail("more than a million words");
        address_ += 2;
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
            if (text[0] == '.') return directive(text) && keep(start, text);
            if (const std::size_t equals = text.find('=');
                equals != std::string_view::npos && is_name(trim(text.substr(0, equals)))) {
                define_value(trim(text.substr(0, equals)), text.substr(equals + 1));
                return true;
            }
            instruction(text);
            return keep(start, text);
        } catch (const ExpressionError& error) {
            fail(error.what(), suggestion(error.what()));
        } catch (const EncodeError& error) {
            fail(error.what(), error.expected);
        }
    }

    bool keep(std::uint32_t start, std::string_view text) {
        const bool words = address_ > start && program_.words.contains(start);  // not a mere .org
        if (final_ && options_.keep_lines && words)
            program_.lines.push_back(
                {start, static_cast<int>((address_ - start) / 2), line_->number, std::string(text)});
        return true;
    }

    /// The defined name that an unknown one may mean.
    std::string suggestion(std::string_view problem) const {
        const std::size_t quote = problem.find('"');
        if (!problem.starts_with("unknown name") || quote == std::string_view::npos) return {};
        const std::string_view name = problem.substr(quote + 1, problem.size() - quote - 2);
        std::vector<std::string_view> known;
        for (const auto& [symbol, number] : values_)
            known.push_back(symbol);
        const std::string near = nearest_name(name, known);
        return near.empty() ? "a label or .equ" : near + "?";
    }

    void instruction(std::string_view text) {
        const Instruction parsed = parse_instruction(text);
        if (address_ & 1) fail(fmt::format("an instruction at the odd address {:#x}", address_));
        if (!final_) {
            address_ += 2 * static_cast<std::uint32_t>(size_of(parsed));
            return;
        }
        const Encoded encoded = encode(parsed, address_, value_of_);
        for (int i = 0; i < encoded.count; ++i)
            emit(encoded.words[static_cast<std::size_t>(i)]);
    }

    void define_value(std::string_view name, std::string_view expression) {
        try {
            define(name, value(expression), true);
        } catch (const ExpressionError&) {
            if (final_) throw;  // may name a label that comes later
        }
    }

    std::uint32_t word_value(std::string_view expression, std::int64_t largest) const {
        if (!final_) return 0;
        const std::int64_t number = value(expression);
        if (number > largest || number < -(largest / 2 + 1))
            fail(fmt::format("{:#x} does not fit", number), fmt::format("up to {:#x}", largest));
        return static_cast<std::uint32_t>(number & largest);
    }

    bool directive(std::string_view text) {
        std::size_t end = 0;
        while (end < text.size() && is_name_char(text[end]))
            ++end;
        const std::string_view name = text.substr(0, end);
        const std::string_view rest = trim(text.substr(end));
        const auto is = [&](std::string_view known) { return equal_ignoring_case(name, known); };
        if (is(".end")) return false;
        if (is(".org")) {
            const std::int64_t target = value(rest);
            if (target < 0 || target >= kAddressEnd || target % 2 != 0)
                fail(fmt::format(".org {:#x}", target), "an even program address below 0x1000000");
            address_ = static_cast<std::uint32_t>(target);
        } else if (is(".equ") || is(".set") || is(".equiv")) {
            const auto parts = split_arguments(rest);
            if (parts.size() != 2)
                fail(fmt::format("{} with {} arguments", name, parts.size()), "a name and a value");
            define_value(parts[0], parts[1]);
        } else if (is(".pword") || is(".word")) {
            for (const std::string_view part : split_arguments(rest))
                emit(word_value(part, is(".word") ? 0xFFFF : kLargestWord));
        } else if (is(".pfill")) {
            fill(split_arguments(rest));
        } else if (is(".ascii") || is(".asciz")) {
            emit_text(rest, is(".asciz"));
        } else if (!is(".text") && !is(".global") && !is(".globl") && !is(".extern") && !is(".section")) {
            fail(fmt::format("unknown directive \"{}\"", name),
                 ".org .equ .pword .word .pfill .ascii .asciz .text .global .include .end");
        }
        return true;
    }

    void fill(const std::vector<std::string_view>& parts) {
        if (parts.size() != 2) fail(".pfill takes a count and a word");
        const std::int64_t count = value(parts[0]);
        if (count < 0 || count > static_cast<std::int64_t>(kMostWords))
            fail(fmt::format(".pfill of {} words", count), fmt::format("0 to {}", kMostWords));
        const std::uint32_t word = word_value(parts[1], kLargestWord);
        for (std::int64_t i = 0; i < count; ++i)
            emit(word);
    }

    void emit_text(std::string_view quoted, bool zero_ended) {
        if (quoted.size() < 2 || quoted.front() != '"' || quoted.back() != '"')
            fail("a text without its quotes");
        std::string characters = unescape(quoted.substr(1, quoted.size() - 2));
        if (zero_ended) characters += '\0';
        for (std::size_t i = 0; i < characters.size(); i += 2) {
            const auto low = static_cast<unsigned char>(characters[i]);
            const auto high =
                static_cast<unsigned char>(i + 1 < characters.size() ? characters[i + 1] : '\0');
            emit(low | static_cast<std::uint32_t>(high) << 8);
        }
    }

    std::string unescape(std::string_view text) const {
        std::string result;
        for (std::size_t i = 0; i < text.size(); ++i) {
            if (text[i] != '\\') {
                result += text[i];
                continue;
            }
            const char c = ++i < text.size() ? text[i] : '?';
            constexpr std::string_view kCodes = "nrt0\\\"";
            constexpr std::string_view kMeans{"\n\r\t\0\\\"", 6};
            const std::size_t at = kCodes.find(c);
            if (at == std::string_view::npos)
                fail(fmt::format("unknown escape \\{}", c), "\\n \\r \\t \\0 \\\\ \\\"");
            result += kMeans[at];
        }
        return result;
    }

    const AssembleOptions& options_;
    SymbolValue value_of_;
    std::map<std::string, std::int64_t, std::less<>> values_;
    std::set<std::string> defined_;
    Program program_;
    const SourceLine* line_ = nullptr;
    std::uint32_t address_ = 0;
    bool final_ = false;
};

}  // namespace

Program assemble(std::string_view source, const AssembleOptions& options) {
    return Assembler(options).run(source);
}

std::vector<std::uint32_t> assemble_words(std::string_view source, std::uint32_t origin) {
    AssembleOptions options;
    options.origin = origin;
    std::vector<std::uint32_t> words;
    for (const auto& [address, word] : assemble(source, options).words)
        words.push_back(word);
    return words;
}

}  // namespace puckloop::dspic
