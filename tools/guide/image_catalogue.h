#pragma once
// Where third-party firmware images come from, and what works with them here. The project ships none of them.

#include <filesystem>
#include <span>
#include <string_view>

namespace puckloop::tools {

struct CataloguedImage {
    std::string_view file;        ///< its name in PUCKLOOP_IMAGES
    std::string_view repository;  ///< on github.com
    std::string_view path;        ///< within the repository
    std::string_view sha256;
    std::string_view board;    ///< as --board takes it
    std::string_view boot;     ///< from power-up until it listens, or ""
    std::string_view about;    ///< what it is
    std::string_view command;  ///< that works; IMAGE is the file
};

std::span<const CataloguedImage> catalogued_images();

/// The row with this checksum; null: none.
const CataloguedImage* catalogued(std::string_view sha256);

/// The folder that PUCKLOOP_IMAGES names; empty: it is not set.
std::filesystem::path images_folder();

}  // namespace puckloop::tools
