#include "emu/dspic/assembler/codec.h"

#include <stdexcept>
#include <string>
#include <string_view>

namespace puckloop::dspic {

namespace {

/// Splits "Wm*Wn,Acc{,X}{,Y}{,AWB}" at its commas; braces only mark what may be left out.
std::vector<std::string> split_operands(std::string_view text) {
    std::vector<std::string> parts;
    std::string part;
    for (const char c : text) {
        if (c == '{' || c == '}') continue;
        if (c == ',') {
            if (!part.empty()) parts.push_back(part);
            part.clear();
        } else {
            part += c;
        }
    }
    if (!part.empty()) parts.push_back(part);
    return parts;
}

}  // namespace

FormCodec::FormCodec(const Form& form) : form_(&form) {
    for (std::size_t i = 0; i < form.pattern.size(); ++i) {
        const char letter = form.pattern[i];
        if (letter == '0' || letter == '1') continue;
        FieldPlace& at = places_[static_cast<std::size_t>(letter - 'A')];
        const auto bit = static_cast<std::uint8_t>(form.pattern.size() - 1 - i);
        if (at.width > 0 && at.shift != bit + 1) at.contiguous = false;
        at.shift = bit;
        ++at.width;
    }
    parse_operands();
}

void FormCodec::parse_operands() {
    using enum OperandKind;
    const auto parts = split_operands(form_->operands);
    const bool bare_pointers = form_->mnemonic == "ED" || form_->mnemonic == "EDAC";
    const auto add = [&](OperandKind kind, char letter = 0) { items_.push_back({kind, letter}); };
    const auto add_register = [&](char letter) { add(width(letter) == 3 ? RegisterPair : Register, letter); };
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const std::string& part = parts[i];
        if (part == "f" && i + 1 < parts.size() && parts[i + 1] == "#bit4") {
            add(FileBit);
            ++i;
        } else if (part == "f") {
            add(File);
        } else if (part == "WREG") {
            add(Wreg);
        } else if (part == "#Slit6") {
            add(SignedLiteral, 'k');
        } else if (part == "#Slit4") {
            add(OptionalShift);
        } else if (part == "#bit4") {
            add(Bit, 'b');
        } else if (part.starts_with("#lit")) {
            const bool even = form_->pattern.back() == '0' && form_->mnemonic == "LNK";
            add(even ? EvenLiteral : Literal, 'k');
        } else if (part == "Wb") {
            add(Register, 'w');
        } else if (part == "Wnd") {
            add_register('d');
        } else if (part == "Wns") {
            add_register('s');
        } else if (part == "Wn") {
            add(Register, has('s') ? 's' : 'd');
        } else if (part == "Wm") {
            add(Register, has('v') ? 'v' : 't');
        } else if (part == "Ws" || part == "[Ws]") {
            add(Source);
        } else if (part == "Wd" || part == "[Wd]") {
            add(Destination);
        } else if (part == "[Ws+Slit10]") {
            add(SourceOffset);
        } else if (part == "[Wd+Slit10]") {
            add(DestinationOffset);
        } else if (part == "Expr") {
            if (!form_->two_words())
                add(Relative);
            else
                add(form_->mnemonic == "DO" ? LoopEnd : Absolute);
        } else if (part == "Acc") {
            add(Accumulator);
        } else if (part == "Wm*Wn") {
            add(Product);
        } else if (part == "Wm*Wm") {
            add(Square);
        } else if (part == "X") {
            add(bare_pointers ? PointerX : PrefetchX);
        } else if (part == "Y") {
            add(bare_pointers ? PointerY : PrefetchY);
        } else if (part == "AWB") {
            add(WriteBack);
        } else if (part == "Wxd") {
            add(DifferenceTarget);
        } else {
            throw std::logic_error("isa table: operand not understood: " + part);
        }
    }
}

const std::vector<FormCodec>& codecs() {
    static const std::vector<FormCodec> instance = [] {
        std::vector<FormCodec> all;
        for (const Form& form : forms())
            all.emplace_back(form);
        return all;
    }();
    return instance;
}

}  // namespace puckloop::dspic
