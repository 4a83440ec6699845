#include "emu/dspic/machine/isa.h"

#include <array>
#include <charconv>
#include <stdexcept>
#include <vector>

namespace puckloop::dspic {

namespace {

/// One comparison on one field, such as "p<=5" or "t=v+1".
struct Atom {
    enum class Kind : std::uint8_t { Range, NotEqual, Even, OneOf, NextOf };
    Kind kind{};
    char letter = 0;
    char other = 0;  ///< NextOf: letter == other + 1
    bool is_signed = false;
    int low = 0;
    int high = 0;
    std::uint32_t set = 0;  ///< OneOf: bit n set = n is legal

    bool holds(const Form& form, std::uint32_t word) const {
        int value = static_cast<int>(form.field(letter, word));
        const int sign = 1 << (form.width(letter) - 1);
        if (is_signed && (value & sign)) value -= 2 * sign;
        switch (kind) {
        case Kind::Range:
            return low <= value && value <= high;
        case Kind::NotEqual:
            return value != low;
        case Kind::Even:
            return (value & 1) == 0;
        case Kind::OneOf:
            return (set >> value) & 1;
        case Kind::NextOf:
            return value == static_cast<int>(form.field(other, word)) + 1;
        }
        return false;
    }
};

/// Alternatives, one of which must hold.
using Clause = std::vector<Atom>;
constexpr int kUnbounded = 1 << 24;

int number(std::string_view text) {
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size())
        throw std::logic_error("isa table: bad number in constraint: " + std::string(text));
    return value;
}

/// Calls `part(piece)` for every piece of `text` between separators.
template <class Part>
void split(std::string_view text, std::string_view separator, Part part) {
    while (true) {
        const auto at = text.find(separator);
        part(text.substr(0, at));
        if (at == std::string_view::npos) return;
        text.remove_prefix(at + separator.size());
    }
}

/// The grammar is that of the table's last column: "p<=5", "1<=p<=5", "s>=2", "d even", "d!=14", "B=0",
/// "t=v+1", "m in 0,1,2".
Atom parse_atom(std::string_view text) {
    Atom atom;
    const auto relation = [&](std::string_view sign) { return text.find(sign); };
    constexpr auto npos = std::string_view::npos;
    if (const auto at = relation(" even"); at != npos) {
        atom.kind = Atom::Kind::Even;
        atom.letter = text[0];
    } else if (const auto in = relation(" in "); in != npos) {
        atom.kind = Atom::Kind::OneOf;
        atom.letter = text[0];
        split(text.substr(in + 4), ",", [&](std::string_view n) { atom.set |= 1u << number(n); });
    } else if (const auto differs = relation("!="); differs != npos) {
        atom.kind = Atom::Kind::NotEqual;
        atom.letter = text[0];
        atom.low = number(text.substr(differs + 2));
    } else if (const auto least = relation(">="); least != npos) {
        atom.letter = text[0];
        atom.low = number(text.substr(least + 2));
        atom.high = kUnbounded;
    } else if (const auto first = relation("<="); first != npos) {
        const auto second = text.find("<=", first + 2);
        if (second == npos) {
            atom.letter = text[0];
            atom.high = number(text.substr(first + 2));
        } else {
            atom.letter = text[first + 2];
            atom.low = number(text.substr(0, first));
            atom.high = number(text.substr(second + 2));
            atom.is_signed = atom.low < 0;
        }
    } else if (const auto equal = relation("="); equal != npos) {
        atom.letter = text[0];
        const auto right = text.substr(equal + 1);
        if (right.ends_with("+1")) {
            atom.kind = Atom::Kind::NextOf;
            atom.other = right[0];
        } else {
            atom.low = atom.high = number(right);
        }
    } else {
        throw std::logic_error("isa table: constraint not understood: " + std::string(text));
    }
    return atom;
}

struct Table {
    std::vector<Form> forms;
    std::vector<std::vector<Clause>> constraints;             ///< parallel to forms
    std::array<std::vector<std::uint8_t>, 256> by_high_byte;  ///< primary forms that bits 23:16 can belong to

    Table();
};

Table::Table() {
#define FORM(id, mnemonic, operands, pattern, pattern2, cycles, psv, stall, flags, limits)                   \
    forms.push_back({FormId::id, #id, mnemonic, operands, pattern, pattern2, cycles, psv, Stall::stall,      \
                     flags, limits, false, 0, 0});
#define ALIAS(id, mnemonic, operands, pattern, pattern2, cycles, psv, stall, flags, limits)                  \
    forms.push_back({FormId::id, #id, mnemonic, operands, pattern, pattern2, cycles, psv, Stall::stall,      \
                     flags, limits, true, 0, 0});
#include "emu/dspic/machine/isa_forms.inc"
#undef FORM
#undef ALIAS
    constraints.resize(forms.size());
    for (std::size_t i = 0; i < forms.size(); ++i) {
        Form& f = forms[i];
        if (f.pattern.size() != 24) throw std::logic_error("isa table: pattern of " + std::string(f.name));
        for (const char c : f.pattern) {
            f.mask = f.mask << 1 | (c == '0' || c == '1');
            f.value = f.value << 1 | (c == '1');
        }
        if (!f.constraints.empty())
            split(f.constraints, ";", [&](std::string_view clause) {
                Clause alternatives;
                split(clause, " or ", [&](std::string_view a) { alternatives.push_back(parse_atom(a)); });
                constraints[i].push_back(alternatives);
            });
        if (f.alias) continue;
        for (std::uint32_t high = 0; high < 256; ++high)
            if (((high << 16 ^ f.value) & f.mask & 0xFF0000) == 0)
                by_high_byte[high].push_back(static_cast<std::uint8_t>(i));
    }
}

const Table& table() {
    static const Table instance;
    return instance;
}

}  // namespace

int Form::width(char letter) const {
    int bits = 0;
    for (const char c : pattern)
        bits += c == letter;
    return bits;
}

std::uint32_t Form::extract(std::string_view pattern, char letter, std::uint32_t word) {
    std::uint32_t result = 0;
    for (std::size_t i = 0; i < pattern.size(); ++i)
        if (pattern[i] == letter) result = result << 1 | (word >> (23 - i) & 1);
    return result;
}

std::uint32_t Form::spread(std::string_view pattern, char letter, std::uint32_t number) {
    std::uint32_t result = 0;
    for (std::size_t i = pattern.size(); i-- > 0;) {
        if (pattern[i] != letter) continue;
        result |= (number & 1) << (23 - i);
        number >>= 1;
    }
    return result;
}

std::span<const Form> forms() {
    return table().forms;
}

const Form& form(FormId id) {
    return table().forms[static_cast<std::size_t>(id)];
}

bool matches(const Form& form, std::uint32_t word) {
    if ((word & form.mask) != form.value) return false;
    for (const Clause& clause : table().constraints[static_cast<std::size_t>(form.id)]) {
        bool one_holds = false;
        for (const Atom& atom : clause)
            one_holds = one_holds || atom.holds(form, word);
        if (!one_holds) return false;
    }
    return true;
}

const Form* find_form(std::uint32_t word) {
    const Table& t = table();
    for (const std::uint8_t i : t.by_high_byte[word >> 16 & 0xFF])
        if (matches(t.forms[i], word)) return &t.forms[i];
    return nullptr;
}

}  // namespace puckloop::dspic
