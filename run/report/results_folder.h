#pragma once
// The folder that a run writes its results to: one run at a time, and nothing of an earlier one stays in it.

#include <filesystem>
#include <string>
#include <vector>

namespace puckloop::tools {

/// The lock file of a run's results, which is the folder's mark as well (base/files/claimed_folder.h).
inline constexpr const char* kRunMark = ".puckloop";

class ResultsFolder {
  public:
    /// Makes the folder, takes its lock and removes what the run before wrote there: that run left the names
    /// of its files in the lock file, and nothing else is touched. `files` are the names that this run may
    /// write, `kept` further ones, of files and folders, that the next run does not remove. InputError if
    /// another process holds the lock (it names that process), as refuse_foreign_results() for these names,
    /// or if the folder or the lock cannot be made.
    ResultsFolder(const std::filesystem::path& folder, const std::vector<std::string>& files,
                  const std::vector<std::string>& kept);
    /// Gives the lock back; the list stays for the next run. A run that is killed gives it back as well.
    ~ResultsFolder();
    ResultsFolder(const ResultsFolder&) = delete;
    ResultsFolder& operator=(const ResultsFolder&) = delete;

  private:
    void lock() const;
    std::string listed() const;
    void remove_listed() const;
    void list(const std::vector<std::string>& files, const std::vector<std::string>& kept) const;

    std::filesystem::path folder_, file_;
    int descriptor_ = -1;
};

}  // namespace puckloop::tools
