// Commands of `puckloop act`; what is taken is the same again when it is written as text and read once more.

#include "base/error.h"
#include "scenarios/reader/events/command_text.h"
#include "tests/fuzz/target.h"

void puckloop::fuzz::run_input(Input input) {
    try {
        const TomlValue table = scenarios::parse_command_text(text_of(input));
        scenarios::verb_of(table);
        scenarios::toml_text(table);
        scenarios::command_text(table);
    } catch (const InputError& error) {
        require_refusal(error.what(), "");
    }
}
