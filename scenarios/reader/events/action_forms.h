#pragma once
// What can be done to a running world, as a user writes it: one table for [[event]] tables and for commands.
// In a table a verb is a key and its object the value, `move = "can"`; in a command the words follow each
// other, `move can to 10 cm, 0 cm`.

#include <span>
#include <string_view>

namespace puckloop::scenarios {

/// How a key's value is written in a command; in a table all are TOML.
enum class ValueForm {
    Text,     ///< words up to the next key
    List,     ///< likewise, separated by commas
    Integer,  ///< digits
};

struct ActionKey {
    std::string_view name;
    ValueForm form = ValueForm::Text;
};

struct ActionForm {
    std::string_view verb;
    std::string_view usage;  ///< of the command
    std::string_view help;
    std::span<const ActionKey> keys;
};

std::span<const ActionForm> action_forms();
const ActionForm* action_form(std::string_view verb);

/// What `add` can add, with the keys of its table in a scenario.
struct ThingForm {
    std::string_view kind;
    std::span<const ActionKey> keys;
};
std::span<const ThingForm> thing_forms();
const ThingForm* thing_form(std::string_view kind);

/// Keys of `verb`, and of `add` those of the thing `object`; empty for unknown ones.
std::span<const ActionKey> keys_of(std::string_view verb, std::string_view object);

}  // namespace puckloop::scenarios
