#pragma once
// The part of ChipAccess that programs images into a chip: those that faults name are read before the run.

#include "emu/chip/faults/chip_access.h"

#include <map>
#include <string>

namespace puckloop::chip {

template <class Chip, class Image>
class ImageAccess : public ChipAccess {
  public:
    void read_image(const std::string& file, const std::string& sha256) final {
        if (!images_.contains(file)) images_.emplace(file, load(file, sha256));
    }
    void program(const std::string& file) final { chip_.program(images_.at(file)); }
    void name_places(const std::string& file) final { chip_.name_places(images_.at(file)); }

  protected:
    explicit ImageAccess(Chip& chip) : chip_(chip) {}

    /// For this chip; throws as read_image() states.
    virtual Image load(const std::string& file, const std::string& sha256) const = 0;

    Chip& chip_;

  private:
    std::map<std::string, Image> images_;  ///< by file
};

}  // namespace puckloop::chip
