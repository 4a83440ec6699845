#pragma once
// The images of a driven run, as they were when it first used them. A program is often built again while the
// run goes on: going back must not find the new one in place of the old one.

#include "run/description/node_description.h"

#include <filesystem>
#include <map>
#include <set>
#include <string>

namespace puckloop::tools {

class KeptImages {
  public:
    /// Copies go into `folder`, which is made for the first one.
    explicit KeptImages(std::filesystem::path folder);

    /// An image that the run begins with.
    void remember(const std::string& file);
    /// `file` if it is still what was remembered, else a copy of that. Throws RunError.
    std::string as_it_was(const std::string& file) const;
    /// All that were remembered.
    const std::set<std::string>& remembered() const { return remembered_; }

    struct Copy {
        std::string file;    ///< absolute
        std::string sha256;  ///< of its bytes
    };
    /// Copies an image that is to be flashed into `board`. Throws InputError: it cannot be read, or is not
    /// for its chip; RunError: the copy cannot be written.
    Copy copy(const NodeDescription& board, const std::string& file) const;

  private:
    std::string written(const std::string& file, const std::string& bytes) const;

    std::filesystem::path folder_;
    std::map<std::string, std::string> bytes_;  ///< by file
    std::set<std::string> remembered_;
};

/// The copies of an earlier run, and the folder if nothing else is in it.
void remove_kept_images(const std::filesystem::path& folder);

}  // namespace puckloop::tools
