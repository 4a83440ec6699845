#pragma once
// What a chip's flash, EEPROM and configuration words hold beyond the end of a run: one text file per board.
//
//   puckloop non-volatile memory 1
//   chip: dspic30f6014a
//   image: <SHA-256 of the image that the board began with>
//   contents: <SHA-256 of everything after this line>
//   :020000040000FA                      Intel HEX, to the end: of a dsPIC in Microchip's address convention,
//                                        of an AVR as avr-objcopy writes it
//
// Without its four lines it is an image that any programmer takes. What the file does not list is erased.
// It is replaced as a whole when a run ends: a run that is killed leaves it as it was.

#include "emu/image/image.h"

#include <optional>
#include <string>
#include <string_view>

namespace puckloop::board {

class NvmFile {
  public:
    /// Reads the file, if there is one, and takes it for this run. Throws InputError: damaged, of another
    /// chip or begun from another image, in use by another board, or in a place that cannot be written.
    NvmFile(std::string path, std::string_view chip, const image::Image& begins_with);
    ~NvmFile();
    NvmFile(const NvmFile&) = delete;
    NvmFile& operator=(const NvmFile&) = delete;

    const std::string& path() const { return path_; }
    /// The image with the memory's words in place of its own; unchanged where there was no file. Throws
    /// InputError for contents that are no such image.
    image::Image over(image::Image image) const;
    /// What the file holds behind its four lines; nothing where there was no file.
    const std::optional<std::string>& contents() const { return contents_; }
    /// Replaces the file. Throws RunError; the old file is then as it was.
    void save(const image::Words& words);
    /// The same for contents that are Intel HEX already.
    void save_contents(const std::string& contents);

  private:
    void take();

    std::string path_, part_;
    std::string chip_, image_;  ///< SHA-256 of the image
    std::optional<std::string> contents_;
    int descriptor_ = -1;  ///< of the file to be, locked
};

}  // namespace puckloop::board
