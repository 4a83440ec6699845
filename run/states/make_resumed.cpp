#include "run/states/make_resumed.h"

#include "base/error.h"
#include "cosim/resume/state_file.h"
#include "run/states/board_identity.h"
#include "run/states/boot_cache.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <tuple>

namespace puckloop::tools {

namespace {

cosim::BoardState state_of(const std::string& path, const std::string& node) {
    cosim::StateFile file = cosim::read_state_file(path);
    const auto found = std::find_if(file.boards.begin(), file.boards.end(),
                                    [&](const auto& state) { return state.board.node == node; });
    if (found == file.boards.end()) throw InputError(path, node, "no state of this board");
    return std::move(*found);
}

void take_from_cache(const std::string& path, cosim::Time at, cosim::ResumeOptions& options) {
    std::error_code error;
    if (!std::filesystem::exists(path, error)) return;
    try {
        cosim::BoardState state = state_of(path, options.board.node);
        if (!(state.board == options.board) || state.time != at) return;
        options.from = std::move(state);
        std::filesystem::last_write_time(path, std::filesystem::file_time_type::clock::now(), error);
    } catch (const InputError&) {
        // Damaged or gone meanwhile: the boot is executed and kept again.
    }
}

}  // namespace

std::unique_ptr<cosim::Node> with_state(const NodeDescription& board, cosim::ResumedNode::Make make) {
    const auto& [from, save] = std::tie(board.care.from_state, board.care.save_state);
    if (!from && !save) return make();
    cosim::ResumeOptions options;
    options.board = identity_of(board);
    if (from) options.source = from->cache ? "cache" : "file";
    options.fall_back = from && from->cache;
    if (save) options.save_at = save->at;
    if (options.fall_back) {
        take_from_cache(from->path, options.save_at, options);
    } else if (from) {
        options.from = state_of(from->path, from->board);
        // Another board, or another seed: noise of its own from here on.
        options.new_random_streams = options.from->board.node != options.board.node ||
                                     options.from->board.parameters != options.board.parameters;
    }
    if (save) {
        const std::string& path = save->path;
        options.save = [path, cached = options.fall_back](cosim::BoardState state) -> std::string {
            try {
                cosim::write_state_file(path, {cosim::build_id(), {std::move(state)}});
                if (cached) prune_cache(std::filesystem::path(path).parent_path());
            } catch (const RunError& error) {
                if (!cached) throw;
                return fmt::format("the boot is not kept: {}", error.what());
            }
            return {};
        };
    }
    return std::make_unique<cosim::ResumedNode>(std::move(make), std::move(options));
}

}  // namespace puckloop::tools
