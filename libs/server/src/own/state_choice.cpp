#include "metier/server/state_choice.hpp"

#include <spdlog/spdlog.h>

#include <system_error>

#include "metier/server/user_folders.hpp"

namespace metier::server {
namespace {

std::filesystem::path stateFolder(const std::filesystem::path& given, std::uint16_t port) {
    if (!given.empty()) {
        return given;
    }
    auto folder = port == 0 ? std::filesystem::path() : userStateFolder();
    std::error_code error;
    if (!folder.empty() && !std::filesystem::create_directories(folder, error) && error) {
        spdlog::warn("{}: {}; after a restart a repeated StartWith may start again",
                     folder.string(), error.message());
        return {};
    }
    return folder;
}

}  // namespace

void chooseState(cell::ServerConfig& config, const StateChoice& choice) {
    config.state_folder = stateFolder(choice.folder, config.port);
    auto& url = config.records.url;
    url = choice.records.empty() ? url : choice.records;
    if (url == "off") {
        url.clear();
    } else if (url.empty() && !config.state_folder.empty()) {
        url = (config.state_folder / "records.db").string();
    }
}

}  // namespace metier::server
