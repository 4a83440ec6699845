#include "emu/dspic/assembler/disassembler.h"

#include "emu/dspic/assembler/codec.h"

#include <cctype>

namespace puckloop::dspic {

namespace {

constexpr std::size_t kOperandColumn = 10;
constexpr std::size_t kLongestLabel = 128;

std::int32_t sign_extend(std::uint32_t value, int width) {
    const std::uint32_t sign = 1u << (width - 1);
    return static_cast<std::int32_t>((value ^ sign)) - static_cast<std::int32_t>(sign);
}

class Writer {
  public:
    Writer(const FormCodec& codec, std::uint32_t word, std::uint32_t next, std::uint32_t address,
           InstructionText& text, const LabelOf* label_of)
        : codec_(codec), word_(word), next_(next), address_(address), text_(text), label_of_(label_of) {}

    void write() {
        const std::size_t start = text_.view().size();
        const bool condition = write_mnemonic(start);
        if (condition || !codec_.items().empty()) text_.pad_to(start + kOperandColumn);
        if (condition) write_condition();
        for (const OperandItem& item : codec_.items())
            write_operand(item);
        write_ignored_bits();
    }

  private:
    std::uint32_t get(char letter) const { return codec_.get(letter, word_); }
    bool is_byte() const { return codec_.has('B') && get('B') != 0; }

    void put_lower(std::string_view name) {
        for (const char c : name)
            text_.put(c >= 'A' && c <= 'Z' ? static_cast<char>(c + ('a' - 'A')) : c);
    }

    /// True for a conditional branch, whose condition stands among the operands.
    bool write_mnemonic(std::size_t) {
        const std::string_view name = codec_.form().mnemonic;
        const std::size_t space = name.find(' ');
        put_lower(name.substr(0, space));
        if (space != std::string_view::npos) return true;
        const bool sized = name.find('.') == std::string_view::npos;
        if (sized && codec_.has('B'))
            text_.put(is_byte() ? ".b" : ".w");
        else if (sized && !codec_.items().empty() && codec_.items()[0].kind == OperandKind::FileBit)
            text_.put(".b");
        else if (name == "MOV" || name == "PUSH" || name == "POP")
            text_.put(".w");
        return false;
    }

    void write_condition() {
        const std::string_view name = codec_.form().mnemonic;
        separate();
        put_lower(name.substr(name.find(' ') + 1));
    }

    void separate() {
        if (!first_) text_.put(", ");
        first_ = false;
    }

    void put_w(std::uint32_t number) {
        text_.put('w');
        if (number >= 10) text_.put('1');
        text_.put(static_cast<char>('0' + number % 10));
    }

    void put_target(std::uint32_t target) {
        std::string_view label = label_of_ ? (*label_of_)(target) : std::string_view{};
        if (!label.empty() && label.size() <= kLongestLabel)
            text_.put(label);
        else
            text_.put_hex(target);
    }

    void put_with_mode(std::uint32_t number, std::uint32_t mode) {
        switch (mode) {
        case kModeDirect:
            put_w(number);
            return;
        case kModePreDecrement:
            text_.put("[--");
            break;
        case kModePreIncrement:
            text_.put("[++");
            break;
        default:
            text_.put('[');
        }
        put_w(number);
        if (mode == kModePostDecrement) text_.put("--");
        if (mode == kModePostIncrement) text_.put("++");
        if (mode >= kModeRegisterOffset) {
            text_.put('+');
            put_w(get('w'));
        }
        text_.put(']');
    }

    void put_with_literal(std::uint32_t number) {
        const int offset = sign_extend(get('k'), codec_.width('k')) * (is_byte() ? 1 : 2);
        text_.put('[');
        put_w(number);
        text_.put(offset < 0 ? '-' : '+');
        text_.put_decimal(offset < 0 ? -offset : offset);
        text_.put(']');
    }

    void put_pointer(std::uint32_t code, std::uint32_t first_register) {
        text_.put('[');
        put_w(first_register + (code >> 3));
        if (code == kPrefetchOffset) text_.put("+w12");
        text_.put(']');
        const int step = code == kPrefetchOffset ? 0 : kPrefetchStep[code & 7];
        if (step == 0) return;
        text_.put(step < 0 ? "-=" : "+=");
        text_.put_decimal(step < 0 ? -step : step);
    }

    void put_prefetch(char code_letter, char target_letter, std::uint32_t first_register) {
        const std::uint32_t code = get(code_letter);
        if (code == kPrefetchNone) return;
        separate();
        put_pointer(code, first_register);
        separate();
        put_w(4 + get(target_letter));
    }

    void write_operand(const OperandItem& item) {
        using enum OperandKind;
        switch (item.kind) {
        case OptionalShift:
            if (get('r') == 0) return;
            separate();
            text_.put('#');
            text_.put_decimal(sign_extend(get('r'), 4));
            return;
        case PrefetchX:
            return put_prefetch('i', 'x', 8);
        case PrefetchY:
            return put_prefetch('j', 'y', 10);
        case WriteBack:
            if (get('a') == kWriteBackNone) return;
            separate();
            return text_.put(get('a') == kWriteBackDirect ? "w13" : "[w13]+=2");
        default:
            separate();
        }
        switch (item.kind) {
        case File:
            return text_.put_hex(codec_.width('f') == 15 ? get('f') << 1 : get('f'));
        case FileBit:
            text_.put_hex(get('f'));
            text_.put(", #");
            return text_.put_hex(get('b'));
        case Wreg:
            return text_.put("wreg");
        case Literal:
        case Bit:
            text_.put('#');
            return text_.put_hex(get(item.letter));
        case EvenLiteral:
            text_.put('#');
            return text_.put_hex(get('k') << 1);
        case SignedLiteral:
            text_.put('#');
            return text_.put_decimal(sign_extend(get('k'), codec_.width('k')));
        case Register:
            return put_w(get(item.letter));
        case RegisterPair:
            return put_w(get(item.letter) * 2);
        case Source:
            return put_with_mode(get('s'), get(codec_.source_mode()));
        case Destination:
            return put_with_mode(get('d'), get(codec_.destination_mode()));
        case SourceOffset:
            return put_with_literal(get('s'));
        case DestinationOffset:
            return put_with_literal(get('d'));
        case Relative:
            return put_target((address_ + 2 + 2 * get('n') - (get('n') & 0x8000 ? 0x20000u : 0u)) &
                              kProgramSpace);
        case Absolute:
            return put_target(get('n') << 1 | (next_ & 0x7F) << 16);
        case LoopEnd: {
            const std::uint32_t n = next_ & 0xFFFF;
            return put_target((address_ + 4 + 2 * n - (n & 0x8000 ? 0x20000u : 0u)) & kProgramSpace);
        }
        case Accumulator:
            return text_.put(get('A') ? 'b' : 'a');
        case Product: {
            const auto& pair = kProductPairs[get('m')];
            put_w(static_cast<std::uint32_t>(pair[0]));
            text_.put('*');
            return put_w(static_cast<std::uint32_t>(pair[1]));
        }
        case Square:
            put_w(4 + get('m'));
            text_.put('*');
            return put_w(4 + get('m'));
        case PointerX:
            return put_pointer(get('i'), 8);
        case PointerY:
            return put_pointer(get('j'), 10);
        case DifferenceTarget:
            return put_w(4 + get('x'));
        default:
            return;
        }
    }

    void hint(char letter, std::uint32_t value) {
        if (value == 0) return;
        text_.put(hinted_ ? "," : " {");
        hinted_ = true;
        text_.put(letter);
        text_.put('=');
        text_.put_hex(value);
    }

    /// Bits that this instruction does not look at, when they are not zero.
    void write_ignored_bits() {
        const Form& form = codec_.form();
        const bool source_offset = codec_.has('g') && get('g') >= kModeRegisterOffset;
        const bool destination_offset = codec_.has('h') && get('h') >= kModeRegisterOffset;
        if ((codec_.has('g') || codec_.has('h')) && !source_offset && !destination_offset)
            hint('w', get('w'));
        if (source_offset && get('g') != kModeRegisterOffset) hint('g', get('g'));
        if (destination_offset && get('h') != kModeRegisterOffset) hint('h', get('h'));
        if (codec_.has('i') && get('i') == kPrefetchNone) hint('x', get('x'));
        if (codec_.has('j') && get('j') == kPrefetchNone) hint('y', get('y'));
        if (form.operands.empty() && codec_.has('x')) hint('x', get('x'));
        if (form.operands == "WREG") hint('f', get('f'));
        if (hinted_) text_.put('}');
    }

    const FormCodec& codec_;
    std::uint32_t word_;
    std::uint32_t next_;
    std::uint32_t address_;
    InstructionText& text_;
    const LabelOf* label_of_;
    bool first_ = true;
    bool hinted_ = false;
};

bool pair_is_sound(const Form& form, std::uint32_t next) {
    for (std::size_t i = 0; i < form.pattern2.size(); ++i)
        if (form.pattern2[i] == '0' && (next >> (23 - i) & 1)) return false;
    return true;
}

const Form* whole_form(std::uint32_t word, std::uint32_t next) {
    const Form* form = find_form(word);
    return form && form->two_words() && !pair_is_sound(*form, next) ? nullptr : form;
}

}  // namespace

void InstructionText::put_hex(std::uint32_t number) {
    put("0x");
    int digits = 1;
    while (digits < 8 && number >> (4 * digits))
        ++digits;
    while (digits-- > 0)
        put("0123456789abcdef"[number >> (4 * digits) & 0xF]);
}

void InstructionText::put_decimal(int number) {
    if (number < 0) {
        put('-');
        number = -number;
    }
    if (number >= 10) put_decimal(number / 10);
    put(static_cast<char>('0' + number % 10));
}

int disassemble(std::uint32_t word, std::uint32_t next, std::uint32_t address, InstructionText& text,
                const LabelOf* label_of) {
    const Form* form = whole_form(word, next);
    if (!form) {
        text.put(".pword    ");
        text.put_hex(word);
        return 1;
    }
    Writer(codecs()[static_cast<std::size_t>(form->id)], word, next, address, text, label_of).write();
    return form->two_words() ? 2 : 1;
}

std::string disassemble(std::uint32_t word, std::uint32_t next, std::uint32_t address) {
    InstructionText text;
    disassemble(word, next, address, text);
    return std::string(text.view());
}

int length_of(std::uint32_t word, std::uint32_t next) {
    const Form* form = whole_form(word, next);
    return form && form->two_words() ? 2 : 1;
}

}  // namespace puckloop::dspic
