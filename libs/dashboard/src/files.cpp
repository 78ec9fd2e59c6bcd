#include "files.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <memory>
#include <string_view>
#include <system_error>
#include <utility>

#include "reply.hpp"

namespace metier::dashboard {
namespace {

namespace fs = std::filesystem;

std::string typeOf(const fs::path& file) {
    using Type = std::pair<std::string_view, std::string_view>;
    constexpr std::array kTypes{
        Type{".stl", "model/stl"},        Type{".dae", "model/vnd.collada+xml"},
        Type{".obj", "model/obj"},        Type{".glb", "model/gltf-binary"},
        Type{".urdf", "application/xml"}, Type{".xml", "application/xml"},
        Type{".png", "image/png"},        Type{".jpg", "image/jpeg"}};
    const auto extension = file.extension().string();
    const auto* const found = std::find_if(
        kTypes.begin(), kTypes.end(), [&](const auto& type) { return extension == type.first; });
    return std::string(found == kTypes.end() ? "application/octet-stream" : found->second);
}

/// Sends a piece of the file. \return false: it cannot be read
bool sendPiece(std::ifstream& file, std::size_t offset, std::size_t length,
               httplib::DataSink& sink) {
    constexpr std::size_t kPiece = 65'536;
    std::array<char, kPiece> piece{};
    file.clear();
    file.seekg(static_cast<std::streamoff>(offset));
    file.read(piece.data(), static_cast<std::streamsize>(std::min(length, piece.size())));
    return file.gcount() > 0 && sink.write(piece.data(), static_cast<std::size_t>(file.gcount()));
}

}  // namespace

std::optional<fs::path> fileBelow(const fs::path& folder, const std::string& name) {
    if (name.find('\0') != std::string::npos) {
        return {};
    }
    std::error_code error;
    const auto root = fs::canonical(folder, error);
    const auto file = error ? root : fs::canonical(root / fs::path(name).relative_path(), error);
    if (error || !fs::is_regular_file(file, error)) {
        return {};
    }
    const auto [end_of_root, rest] =
        std::mismatch(root.begin(), root.end(), file.begin(), file.end());
    return end_of_root == root.end() ? std::optional(file) : std::nullopt;
}

void serveFile(const std::optional<fs::path>& file, httplib::Response& response) {
    std::error_code error;
    const auto size = file ? fs::file_size(*file, error) : 0;
    // Shared by the copies of the function that sends it.
    const auto stream = file ? std::make_shared<std::ifstream>(*file, std::ios::binary) : nullptr;
    if (!stream || !*stream || error) {
        return write(errorReply(404, "http", "no such file"), response);
    }
    if (size == 0) {
        return response.set_content("", typeOf(*file));
    }
    response.set_content_provider(
        size, typeOf(*file),
        [stream](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
            return sendPiece(*stream, offset, length, sink);
        });
}

}  // namespace metier::dashboard
