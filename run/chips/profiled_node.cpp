#include "run/chips/profiled_node.h"

#include "base/json.h"
#include "debug/profile/profile.h"
#include "emu/image/symbol_sizes.h"
#include "run/chips/board_around.h"
#include "run/chips/board_chip.h"
#include "run/chips/image_names.h"

#include <utility>

namespace puckloop::tools {

namespace {

using nlohmann::ordered_json;

/// What an image calls its places and variables.
struct Names {
    debug::Places places;
    debug::Variables variables;
};

Names names_of(const std::string& firmware, const debug::DebugChip& chip) {
    ImageNames names = names_in(firmware, is_avr(chip));
    return {debug::Places(names.symbols, std::move(names.lines)),
            debug::Variables(names.symbols, image::symbol_sizes(firmware), chip.ram_start(), chip.ram_end(),
                             !chip.stack_grows_up())};
}

class ProfiledNode final : public BoardAround {
  public:
    ProfiledNode(std::unique_ptr<cosim::StatefulNode> board, const std::string& firmware)
        : BoardAround(std::move(board)),
          chip_(chip_of(this->board()).chip),
          names_(names_of(firmware, *chip_)),
          profile_(*chip_) {
        chip_->set_instrument(&profile_, true);
    }

    // It does not go back (rewindable()): what is executed counts once.

    std::string finish() override {
        chip_->set_instrument(nullptr, false);
        profile_.finish(chip_->cycle());
        ordered_json report = ordered_json::parse(BoardAround::finish());
        report["stats"] =
            ordered_json::parse(profile_json(profile_, names_.places, names_.variables, *chip_));
        const std::string warning = stack_warning(profile_, names_.variables, *chip_);
        if (!warning.empty()) report["warnings"].push_back(warning);
        return report.dump();
    }

  private:
    std::unique_ptr<debug::DebugChip> chip_;
    Names names_;
    debug::Profile profile_;
};

}  // namespace

std::unique_ptr<cosim::StatefulNode> make_profiled(std::unique_ptr<cosim::StatefulNode> board,
                                                   const std::string& firmware) {
    return std::make_unique<ProfiledNode>(std::move(board), firmware);
}

}  // namespace puckloop::tools
