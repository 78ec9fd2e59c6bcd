#include "metier/skill/execution_names.hpp"

#include <fmt/format.h>

#include <utility>

#include "disk_names.hpp"
#include "name_writer.hpp"

namespace metier::skill {

namespace {

/// One line without its end, whatever the client's name holds.
std::string entryOf(std::string_view skill, std::string_view name) {
    std::string entry(skill);
    entry += '\t';
    for (const char letter : name) {
        if (letter == '%' || static_cast<unsigned char>(letter) < ' ') {
            entry += fmt::format("%{:02x}", static_cast<unsigned char>(letter));
        } else {
            entry += letter;
        }
    }
    return entry;
}

}  // namespace

ExecutionNames::ExecutionNames(std::size_t least) : least_(least) {}

ExecutionNames::ExecutionNames(std::unique_ptr<NameFile> file, const Options& options)
    : least_(options.least),
      writer_(std::make_unique<NameWriter>(std::move(file), options.longest_write)) {}

ExecutionNames::~ExecutionNames() = default;

Result<std::unique_ptr<ExecutionNames>> ExecutionNames::open(const std::filesystem::path& file,
                                                             std::size_t least) {
    DiskNames::Known known;
    METIER_ASSIGN(auto opened, DiskNames::open(file, known));
    auto names = std::make_unique<ExecutionNames>(std::move(opened), Options{.least = least});
    names->newer_ = std::move(known.newer);
    names->older_ = std::move(known.older);
    return names;
}

bool ExecutionNames::knows(std::string_view skill, std::string_view name) const {
    const auto entry = entryOf(skill, name);
    return newer_.contains(entry) || older_.contains(entry);
}

Result<ExecutionNames::Keeping> ExecutionNames::note(std::string_view skill, std::string_view name,
                                                     OnKept on_kept) {
    auto entry = entryOf(skill, name);
    const bool full = newer_.size() >= least_;
    if (writer_) {
        METIER_TRY(writer_->add({entry + "\n", full, std::move(on_kept)}));
    }
    if (full) {
        older_ = std::exchange(newer_, {});
    }
    newer_.insert(std::move(entry));
    return writer_ ? Keeping::under_way : Keeping::kept;
}

void ExecutionNames::forget(std::string_view skill, std::string_view name) {
    const auto entry = entryOf(skill, name);
    newer_.erase(entry);
    older_.erase(entry);
}

std::string forgottenText(std::string_view name) {
    return fmt::format("execution \"{}\" has begun once, and its record is gone", name);
}

}  // namespace metier::skill
