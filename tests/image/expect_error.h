#pragma once
// The text of the InputError that a call throws; empty if it throws none.

#include "base/error.h"

#include <string>

namespace puckloop::image::testing {

template <class Call>
std::string error_of(Call call) {
    try {
        call();
    } catch (const InputError& error) {
        return error.what();
    }
    return {};
}

}  // namespace puckloop::image::testing
