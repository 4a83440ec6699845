#include "emu/dspic/assembler/encoder.h"

#include "emu/dspic/assembler/mnemonics.h"

#include <fmt/format.h>

#include <set>

namespace puckloop::dspic {

namespace {

using Shape = Operand::Shape;

/// Encodes one instruction as one particular form, or finds that it is another one's.
class FormEncoder {
  public:
    FormEncoder(const Candidate& candidate, std::span<const Operand> operands, std::uint32_t address,
                const SymbolValue* value_of)
        : candidate_(candidate),
          codec_(*candidate.codec),
          list_(operands),
          address_(address),
          value_of_(value_of),
          word_(codec_.form().value) {}

    /// False if the operands' shapes are not this form's. Without symbols only shapes are looked at.
    bool run() {
        if (candidate_.byte >= 0 && codec_.has('B')) set('B', static_cast<std::uint32_t>(candidate_.byte));
        for (const OperandItem& item : codec_.items())
            if (!take(item)) return false;
        return at_ == list_.size();
    }

    std::uint32_t word() const { return word_; }
    std::uint32_t second() const { return second_; }
    std::string_view problem() const { return problem_; }
    void set(char letter, std::uint32_t number) { word_ |= codec_.put(letter, number); }

  private:
    const Operand* next(Shape shape) {
        if (at_ >= list_.size() || list_[at_].shape != shape) return nullptr;
        return &list_[at_++];
    }
    const Operand* peek(Shape shape) const {
        return at_ < list_.size() && list_[at_].shape == shape ? &list_[at_] : nullptr;
    }

    std::int64_t number(std::string_view expression) const {
        return value_of_ ? evaluate(expression, address_, *value_of_) : 0;
    }

    void report(std::string problem) {
        if (problem_.empty() && value_of_) problem_ = std::move(problem);
    }

    /// `value` checked against [low, high].
    std::uint32_t in_range(std::int64_t value, std::int64_t low, std::int64_t high, std::string_view what) {
        if (value < low || value > high)
            report(fmt::format("{} {} is outside {} to {}", what, value, low, high));
        return static_cast<std::uint32_t>(value);
    }

    std::uint32_t even(std::int64_t value, std::string_view what) {
        if (value & 1) report(fmt::format("{} {:#x} is odd", what, value));
        return static_cast<std::uint32_t>(value >> 1);
    }

    bool take(const OperandItem& item) {
        using enum OperandKind;
        switch (item.kind) {
        case File:
            return take_file();
        case FileBit:
            return take_file_bit();
        case Wreg:
            return next(Shape::Wreg) != nullptr;
        case Literal:
        case EvenLiteral:
        case SignedLiteral:
        case Bit:
            return take_literal(item);
        case Register:
            if (!peek(Shape::Register) || list_[at_].mode != kModeDirect) return false;
            set(item.letter, list_[at_].number);
            if (item.letter == 'v' && codec_.has('t')) set('t', list_[at_].number + 1u);
            ++at_;
            return true;
        case RegisterPair:
            if (!peek(Shape::Register) || list_[at_].mode != kModeDirect) return false;
            set(item.letter, even(list_[at_].number, "the register pair's number"));
            ++at_;
            return true;
        case Source:
            return take_with_mode('s', codec_.source_mode());
        case Destination:
            return take_with_mode('d', codec_.destination_mode());
        case SourceOffset:
            return take_offset('s');
        case DestinationOffset:
            return take_offset('d');
        case Relative:
        case LoopEnd:
        case Absolute:
            return take_target(item.kind);
        case Accumulator:
            if (const Operand* operand = next(Shape::Accumulator)) {
                set('A', operand->number);
                return true;
            }
            return false;
        case OptionalShift:
            if (const Operand* operand = next(Shape::Literal))
                set('r', in_range(number(operand->expression), -8, 7, "the shift"));
            return true;
        case Product:
            return take_product();
        case Square:
            return take_square();
        case PrefetchX:
            return take_prefetch('i', 'x', 8, true);
        case PrefetchY:
            return take_prefetch('j', 'y', 10, true);
        case PointerX:
            return take_prefetch('i', 0, 8, false);
        case PointerY:
            return take_prefetch('j', 0, 10, false);
        case DifferenceTarget:
            return take_prefetch_target('x');
        case WriteBack:
            return take_write_back();
        }
        return false;
    }

    bool take_file() {
        const Operand* operand = next(Shape::Expression);
        if (!operand) return false;
        const std::int64_t value = number(operand->expression);
        if (codec_.width('f') == 15)
            set('f', even(in_range(value, 0, 0xFFFF, "the data address"), "the word address"));
        else
            set('f', in_range(value, 0, 0x1FFF, "the near data address"));
        return true;
    }

    bool take_file_bit() {
        const Operand* file = next(Shape::Expression);
        const Operand* bit = next(Shape::Literal);
        if (!file || !bit) return false;
        std::uint32_t address = in_range(number(file->expression), 0, 0x1FFF, "the near data address");
        std::uint32_t index =
            in_range(number(bit->expression), 0, candidate_.byte == 1 ? 7 : 15, "the bit number");
        if (candidate_.byte != 1) {
            even(address, "the word address");
            address |= index >> 3;
            index &= 7;
        }
        set('f', address);
        set('b', index);
        return true;
    }

    bool take_literal(const OperandItem& item) {
        const Operand* operand = next(Shape::Literal);
        if (!operand) return false;
        const std::int64_t value = number(operand->expression);
        const int width = codec_.width(item.letter);
        if (item.kind == OperandKind::EvenLiteral)
            set('k', even(in_range(value, 0, (2 << width) - 2, "the literal"), "the literal"));
        else if (item.kind == OperandKind::SignedLiteral)
            set('k', in_range(value, -(1 << (width - 1)), (1 << (width - 1)) - 1, "the literal"));
        else if (item.kind == OperandKind::Literal && (width == 16 || width == 8))
            set('k', in_range(value, -(1 << (width - 1)), (1 << width) - 1, "the literal"));
        else
            set(item.letter, in_range(value, 0, (1 << width) - 1,
                                      item.kind == OperandKind::Bit ? "the bit number" : "the literal"));
        return true;
    }

    bool take_with_mode(char letter, char mode_letter) {
        if (const Operand* operand = next(Shape::Register)) {
            set(letter, operand->number);
            set(mode_letter, operand->mode);
            return true;
        }
        const Operand* operand =
            mode_letter == 'g' || mode_letter == 'h' ? next(Shape::RegisterOffset) : nullptr;
        if (!operand) return false;
        set(letter, operand->number);
        set(mode_letter, kModeRegisterOffset);
        if (offset_register_ >= 0 && offset_register_ != operand->second)
            report("both [Wn+Wb] operands share one offset register");
        offset_register_ = operand->second;
        set('w', operand->second);
        return true;
    }

    bool take_offset(char letter) {
        const Operand* operand = next(Shape::LiteralOffset);
        if (!operand) return false;
        std::int64_t offset = number(operand->expression);
        if (operand->negative) offset = -offset;
        set(letter, operand->number);
        if (candidate_.byte == 1)
            set('k', in_range(offset, -512, 511, "the offset"));
        else
            set('k',
                even(static_cast<std::int32_t>(in_range(offset, -1024, 1022, "the offset")), "the offset"));
        return true;
    }

    bool take_target(OperandKind kind) {
        const Operand* operand = next(Shape::Expression);
        if (!operand) return false;
        const std::int64_t value = number(operand->expression);
        const std::uint32_t target = in_range(value, 0, kProgramSpace, "the target");
        if (target & 1) report(fmt::format("the target {:#x} is odd", target));
        if (kind == OperandKind::Absolute) {
            set('n', target >> 1);
            second_ = target >> 16;
            return true;
        }
        const std::uint32_t from = address_ + (kind == OperandKind::LoopEnd ? 4 : 2);
        std::int32_t words = static_cast<std::int32_t>((target - from) << 9) >> 10;  // wraps at 23 bits
        if (!value_of_) words = 0;
        if (words < -0x8000 || words > 0x7FFF)
            report(fmt::format("the target {:#x} is {} words away: only -32768 to 32767 can be reached",
                               target, words));
        if (kind == OperandKind::LoopEnd)
            second_ = static_cast<std::uint32_t>(words) & 0xFFFF;
        else
            set('n', static_cast<std::uint32_t>(words));
        return true;
    }

    bool take_product() {
        const Operand* operand = next(Shape::Product);
        if (!operand || operand->number == operand->second) return false;
        for (std::uint32_t m = 0; m < kProductPairs.size(); ++m) {
            const auto& pair = kProductPairs[m];
            if ((operand->number == pair[0] && operand->second == pair[1]) ||
                (operand->number == pair[1] && operand->second == pair[0])) {
                set('m', m);
                return true;
            }
        }
        report(fmt::format("{} multiplies other registers than W4 to W7", operand->text));
        return true;
    }

    bool take_square() {
        const Operand* operand = next(Shape::Product);
        if (!operand || operand->number != operand->second) return false;
        set('m', in_range(operand->number, 4, 7, "the squared register") - 4);
        return true;
    }

    bool take_prefetch_target(char letter) {
        if (!peek(Shape::Register) || list_[at_].mode != kModeDirect) return false;
        set(letter, in_range(list_[at_].number, 4, 7, "the prefetch register") - 4);
        ++at_;
        return true;
    }

    /// [W8] ... of X (W8, W9) or Y (W10, W11), when it stands here.
    bool take_prefetch(char code_letter, char target_letter, unsigned first, bool optional) {
        const Operand* operand = at_ < list_.size() ? &list_[at_] : nullptr;
        const bool indirect =
            operand && (operand->shape == Shape::Stepped || operand->shape == Shape::RegisterOffset ||
                        (operand->shape == Shape::Register && operand->mode == kModeIndirect));
        if (!indirect || operand->number < first || operand->number > first + 1) {
            if (optional) set(code_letter, kPrefetchNone);
            return optional;
        }
        std::uint32_t code = (operand->number - first) << 3;
        if (operand->shape == Shape::RegisterOffset) {
            if (operand->number != first + 1 || operand->second != 12)
                report(fmt::format("{}: only [W{}+W12] exists", operand->text, first + 1));
            code = kPrefetchOffset;
        }
        for (std::uint32_t step = 0; step < kPrefetchStep.size(); ++step)
            if (operand->step != 0 && kPrefetchStep[step] == operand->step) code |= step;
        set(code_letter, code);
        ++at_;
        return target_letter == 0 || take_prefetch_target(target_letter);
    }

    bool take_write_back() {
        std::uint32_t code = kWriteBackNone;
        if (at_ < list_.size() && list_[at_].number == 13) {
            const Operand& operand = list_[at_];
            const bool stepped = operand.shape == Shape::Stepped && operand.step == 2;
            const bool post = operand.shape == Shape::Register && operand.mode == kModePostIncrement;
            const bool direct = operand.shape == Shape::Register && operand.mode == kModeDirect;
            if (!stepped && !post && !direct) return false;
            code = direct ? kWriteBackDirect : kWriteBackIncrement;
            ++at_;
        }
        set('a', code);
        return true;
    }

    const Candidate& candidate_;
    const FormCodec& codec_;
    std::span<const Operand> list_;
    std::uint32_t address_;
    const SymbolValue* value_of_;
    std::uint32_t word_;
    std::uint32_t second_ = 0;
    std::size_t at_ = 0;
    int offset_register_ = -1;
    std::string problem_;
};

[[noreturn]] void fail_no_form(const Instruction& instruction, const std::vector<Candidate>& candidates) {
    std::string known;
    std::set<std::string_view> listed;
    for (const Candidate& candidate : candidates) {
        const std::string_view operands = candidate.codec->form().operands;
        if (!listed.insert(operands).second) continue;
        known +=
            fmt::format("{}{}", known.empty() ? "" : " or ", operands.empty() ? "no operands" : operands);
    }
    throw EncodeError(fmt::format("{} does not take these operands", instruction.mnemonic), known);
}

/// Puts "{w=3,g=7}" back into the word.
void set_ignored_bits(FormEncoder& encoder, const FormCodec& codec, std::string_view hints) {
    static const SymbolValue no_symbols = [](std::string_view) { return std::nullopt; };
    while (!hints.empty()) {
        const std::size_t comma = hints.find(',');
        const std::string_view hint = trim(hints.substr(0, comma));
        hints = comma == std::string_view::npos ? std::string_view{} : hints.substr(comma + 1);
        if (hint.size() < 3 || hint[1] != '=' || hint[0] < 'a' || hint[0] > 'z' || !codec.has(hint[0]))
            throw EncodeError(fmt::format("\"{}\" names no ignored bits of this instruction", hint),
                              "a field letter, '=' and a number");
        const std::int64_t value = evaluate(hint.substr(2), 0, no_symbols);
        if (value < 0 || value >> codec.width(hint[0]) != 0)
            throw EncodeError(fmt::format("{} does not fit its {} bits", hint, codec.width(hint[0])), "");
        encoder.set(hint[0], static_cast<std::uint32_t>(value));
    }
}

struct Choice {
    const std::vector<Candidate>& candidates;
    std::span<const Operand> operands;
};

/// The candidates of the mnemonic, and the operands left when a branch condition was part of it.
Choice choose(const Instruction& instruction) {
    const std::span<const Operand> operands = instruction.list();
    if (operands.size() == 2 && equal_ignoring_case(instruction.mnemonic, "bra")) {
        if (const std::vector<Candidate>* found = find_condition(operands[0].text))
            return {*found, operands.subspan(1)};
        throw EncodeError(fmt::format("unknown condition \"{}\"", operands[0].text),
                          "ov c z n le lt leu nov nc nz nn gt ge gtu geu ltu oa ob sa sb");
    }
    if (const std::vector<Candidate>* found = find_mnemonic(instruction.mnemonic)) return {*found, operands};
    const std::string near = nearest_mnemonic(instruction.mnemonic);
    throw EncodeError(fmt::format("unknown instruction \"{}\"", instruction.mnemonic),
                      near.empty() ? "a dsPIC mnemonic" : near + "?");
}

}  // namespace

Instruction parse_instruction(std::string_view text) {
    Instruction instruction;
    text = trim(text);
    if (!text.empty() && text.back() == '}') {
        const std::size_t open = text.find('{');
        if (open == std::string_view::npos) throw EncodeError("a '}' without its '{'", "");
        instruction.ignored_bits = text.substr(open + 1, text.size() - open - 2);
        text = trim(text.substr(0, open));
    }
    std::size_t end = 0;
    while (end < text.size() && text[end] != ' ' && text[end] != '\t')
        ++end;
    instruction.mnemonic = text.substr(0, end);
    std::string_view rest = trim(text.substr(end));
    std::string problem;
    while (!rest.empty()) {
        if (instruction.operand_count == Instruction::kMostOperands)
            throw EncodeError("too many operands", "at most 8");
        std::size_t comma = 0;
        int depth = 0;  // commas inside brackets and after a quote belong to the operand
        for (; comma < rest.size(); ++comma) {
            const char c = rest[comma];
            if (c == '\'' && comma + 2 < rest.size() && rest[comma + 2] == '\'') comma += 2;
            depth += (c == '(' || c == '[') - (c == ')' || c == ']');
            if (c == ',' && depth <= 0) break;
        }
        const std::size_t length = comma < rest.size() ? comma : rest.size();
        if (!parse_operand(rest.substr(0, length), instruction.operands[instruction.operand_count], problem))
            throw EncodeError(problem, "");
        ++instruction.operand_count;
        if (comma >= rest.size()) break;
        rest = trim(rest.substr(comma + 1));
        if (rest.empty()) throw EncodeError("an operand is missing after the last comma", "");
    }
    return instruction;
}

int size_of(const Instruction& instruction) {
    const auto [candidates, operands] = choose(instruction);
    for (const Candidate& candidate : candidates) {
        FormEncoder encoder(candidate, operands, 0, nullptr);
        if (encoder.run()) return candidate.codec->form().two_words() ? 2 : 1;
    }
    fail_no_form(instruction, candidates);
}

Encoded encode(const Instruction& instruction, std::uint32_t address, const SymbolValue& value_of) {
    const auto [candidates, operands] = choose(instruction);
    std::string problem;
    for (const Candidate& candidate : candidates) {
        FormEncoder encoder(candidate, operands, address, &value_of);
        if (!encoder.run()) continue;
        const Form& form = candidate.codec->form();
        if (!encoder.problem().empty()) {
            if (problem.empty()) problem = encoder.problem();
            continue;
        }
        set_ignored_bits(encoder, *candidate.codec, instruction.ignored_bits);
        if (matches(form, encoder.word()))
            return {{encoder.word(), encoder.second()}, form.two_words() ? 2 : 1};
        if (problem.empty())
            problem = fmt::format("{} {} does not allow these values: {}", form.mnemonic, form.operands,
                                  form.constraints);
    }
    if (!problem.empty()) throw EncodeError(problem, "");
    fail_no_form(instruction, candidates);
}

}  // namespace puckloop::dspic
