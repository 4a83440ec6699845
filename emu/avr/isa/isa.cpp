#include "emu/avr/isa/isa.h"

#include <vector>

namespace puckloop::avr {

namespace {

constexpr Form make_form(FormId id, Role role, std::string_view name, std::string_view mnemonic,
                         std::string_view operands, std::string_view pattern, std::string_view second,
                         std::uint8_t cycles, Extra extra, std::string_view flags) {
    Form form{id, role, name, mnemonic, operands, BitPattern(pattern), {}, false, cycles, extra, flags};
    if (!second.empty()) {
        form.second = BitPattern(second);
        form.two_words = true;
    }
    if (flags.size() != 8) throw std::logic_error("eight flag codes are expected");
    return form;
}

constexpr Form kForms[] = {
#define LINE(role, id, mnemonic, operands, pattern, second, cycles, extra, flags)                            \
    make_form(FormId::id, Role::role, #id, mnemonic, operands, pattern, second, cycles, Extra::extra, flags),
#define FORM(...) LINE(Primary, __VA_ARGS__)
#define ALIAS(...) LINE(Alias, __VA_ARGS__)
#define SYNONYM(...) LINE(Synonym, __VA_ARGS__)
#include "emu/avr/isa/forms.inc"
#undef FORM
#undef ALIAS
#undef SYNONYM
#undef LINE
};

constexpr bool no_two_overlap(Role role) {
    for (const Form& a : kForms)
        for (const Form& b : kForms)
            if (a.id < b.id && a.role == role && b.role == role && a.pattern.overlaps(b.pattern))
                return false;
    return true;
}

/// Every word of a second spelling must belong to one primary form of the same length.
constexpr bool spellings_are_covered() {
    for (const Form& spelling : kForms) {
        if (spelling.role == Role::Primary) continue;
        bool covered = false;
        for (const Form& form : kForms)
            covered = covered || (form.role == Role::Primary && form.two_words == spelling.two_words &&
                                  (form.pattern.mask() & ~spelling.pattern.mask()) == 0 &&
                                  form.pattern.matches(spelling.pattern.value()));
        if (!covered) return false;
    }
    return true;
}

static_assert(no_two_overlap(Role::Primary), "two forms share a word");
static_assert(no_two_overlap(Role::Alias), "a word has two preferred spellings");
static_assert(spellings_are_covered(), "an alias names a word that no form has");

/// The form of every first word, filled from the patterns.
std::vector<FormId> fill_words(Role role) {
    std::vector<FormId> words(0x10000, FormId::Undefined);
    for (const Form& form : kForms) {
        if (form.role != role) continue;
        const auto free = static_cast<std::uint16_t>(~form.pattern.mask());
        std::uint16_t bits = 0;
        do {
            words[form.pattern.value() | bits] = form.id;
            bits = static_cast<std::uint16_t>((bits - free) & free);  // the next subset of the free bits
        } while (bits != 0);
    }
    return words;
}

const Form* look_up(const std::vector<FormId>& words, std::uint16_t word) {
    const FormId id = words[word];
    return id == FormId::Undefined ? nullptr : &kForms[static_cast<std::size_t>(id)];
}

const std::vector<FormId>& primary_words() {
    static const std::vector<FormId> words = fill_words(Role::Primary);
    return words;
}

}  // namespace

std::span<const Form> forms() {
    return kForms;
}

const Form& form(FormId id) {
    return kForms[static_cast<std::size_t>(id)];
}

const Form* find_form(std::uint16_t word) {
    return look_up(primary_words(), word);
}

FormId find_form_id(std::uint16_t word) {
    return primary_words()[word];
}

const Form* find_spelling(std::uint16_t word) {
    static const std::vector<FormId> aliases = fill_words(Role::Alias);
    const Form* alias = look_up(aliases, word);
    return alias ? alias : find_form(word);
}

int length_of(std::uint16_t word) {
    const Form* form = find_form(word);
    return form && form->two_words ? 2 : 1;
}

}  // namespace puckloop::avr
