#pragma once
// An effect of a study's catalogue by its name.

#include "gap/fit/study.h"

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

namespace puckloop::gap {

/// Index in Study::candidates(); logic_error where there is none.
inline std::size_t candidate(const Study& study, std::string_view name) {
    for (std::size_t i = 0; i < study.candidates().size(); ++i)
        if (study.candidates()[i].effect->name == name) return i;
    throw std::logic_error("no such effect: " + std::string(name));
}

}  // namespace puckloop::gap
