// What clients of a run type: conditions, places, frames. What is taken is an object that can be sent.

#include "base/error.h"
#include "base/json.h"
#include "run/chips/value_words.h"
#include "run/driven/words.h"
#include "tests/fuzz/target.h"

#include <string_view>

namespace {

template <class Parse>
void try_words(Parse parse) {
    try {
        const nlohmann::json taken = parse();
        puckloop::fuzz::require(taken.is_object(), "words that are no object");
    } catch (const puckloop::InputError& error) {
        puckloop::fuzz::require_refusal(error.what(), "");
    }
}

}  // namespace

void puckloop::fuzz::run_input(Input input) {
    const std::string_view text = text_of(input);
    try_words([&] { return tools::condition_of_words(text, "robot0.pic"); });
    try_words([&] { return tools::place_of_words(text); });
    try_words([&] { return tools::frame_of_words(text); });
}
