#include "base/error.h"
#include "bench/targets/target.h"
#include "emu/image/chip_guess.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace puckloop::exec {

std::string board_for(const std::string& image) {
    if (image.ends_with(".toml"))
        throw InputError(image, "", "is a scenario, no firmware image", "puckloop run FILE");
    constexpr std::pair<std::string_view, std::string_view> kBoards[] = {
        {"dspic30f6014a", "pic"}, {"dspic33fj256gp710", "rab"}, {"atmega1284p", "tam"}};
    std::string board, fitting;
    std::size_t count = 0;
    for (const std::string& one : image::chips_that_fit(image)) {
        const auto* const row = std::find_if(std::begin(kBoards), std::end(kBoards),
                                             [&](const auto& known) { return known.first == one; });
        fitting += (count++ == 0 ? "--board " : " or --board ") + std::string(row->second);
        board = row->second;
    }
    if (count == 0)
        throw InputError(image, "", "fits the chip of no known board", "--mcu CHIP or --board BOARD");
    if (count > 1) throw InputError(image, "", "fits the chips of several boards", fitting);
    return board;
}

}  // namespace puckloop::exec
