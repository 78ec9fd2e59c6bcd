// Which files of a folder browsers get, and as what.
#include "files.hpp"

#include <gmock/gmock.h>

#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace metier::dashboard {
namespace {

namespace fs = std::filesystem;

class FilesTest : public ::testing::Test {
protected:
    FilesTest()
        : place_(fs::canonical(fs::path(::testing::TempDir())) /
                 ("files_" + std::to_string(getpid()))),
          folder_(place_ / "web") {
        fs::create_directories(folder_ / "part");
        put(folder_ / "a.stl", "solid");
        put(folder_ / "part" / "b.obj", "v 0 0 0");
        put(place_ / "secret.txt", "for nobody");
        put(place_ / "web2" / "other.txt", "of another folder");
    }
    ~FilesTest() override { fs::remove_all(place_); }

    static void put(const fs::path& file, const std::string& text) {
        fs::create_directories(file.parent_path());
        std::ofstream(file) << text;
    }
    /// All that the answer's provider sends.
    static std::string bodyOf(const httplib::Response& response) {
        if (!response.content_provider_) {
            return response.body;
        }
        std::string body;
        httplib::DataSink sink;
        sink.write = [&body](const char* bytes, std::size_t size) {
            body.append(bytes, size);
            return true;
        };
        while (body.size() < response.content_length_) {
            if (!response.content_provider_(body.size(), response.content_length_ - body.size(),
                                            sink)) {
                break;
            }
        }
        return body;
    }

    const fs::path place_;
    const fs::path folder_;
};

TEST_F(FilesTest, AreFoundBelowTheFolder) {
    EXPECT_EQ(fileBelow(folder_, "a.stl"), folder_ / "a.stl");
    EXPECT_EQ(fileBelow(folder_, "/a.stl"), folder_ / "a.stl");
    EXPECT_EQ(fileBelow(folder_, "part/../part/./b.obj"), folder_ / "part" / "b.obj");
    EXPECT_EQ(fileBelow(folder_ / "", "a.stl"), folder_ / "a.stl") << "with a slash at its end";
    EXPECT_EQ(fileBelow(folder_ / "part" / "..", "a.stl"), folder_ / "a.stl");
}

TEST_F(FilesTest, AreNotFoundElsewhere) {
    for (const std::string name :
         {"../secret.txt", "part/../../secret.txt", "../web2/other.txt", "/../secret.txt",
          "//../secret.txt", "", "/", ".", "..", "part", "none.stl", "a.stl/", "a.stl/b"}) {
        EXPECT_FALSE(fileBelow(folder_, name)) << name;
    }
    EXPECT_FALSE(fileBelow(folder_, (place_ / "secret.txt").string())) << "an absolute path";
    EXPECT_FALSE(fileBelow(folder_, std::string("a.stl\0.png", 10)));
    EXPECT_FALSE(fileBelow(folder_, std::string(10'000, 'a')));
    EXPECT_FALSE(fileBelow(place_ / "none", "a.stl"));
}

TEST_F(FilesTest, AreFollowedByLinksWithinTheFolderAlone) {
    fs::create_symlink("a.stl", folder_ / "same.stl");
    fs::create_symlink(place_ / "secret.txt", folder_ / "out.txt");
    fs::create_symlink("../secret.txt", folder_ / "relative.txt");
    fs::create_directory_symlink(place_ / "web2", folder_ / "web2");
    fs::create_symlink("loop", folder_ / "loop");
    fs::create_symlink("gone", folder_ / "dangling");
    EXPECT_EQ(fileBelow(folder_, "same.stl"), folder_ / "a.stl");
    for (const std::string name :
         {"out.txt", "relative.txt", "web2/other.txt", "loop", "dangling"}) {
        EXPECT_FALSE(fileBelow(folder_, name)) << name;
    }
    fs::create_directory_symlink(folder_, place_ / "linked");
    EXPECT_EQ(fileBelow(place_ / "linked", "a.stl"), folder_ / "a.stl")
        << "the folder itself may be a link";
}

TEST_F(FilesTest, AreNoPipesNorSockets) {
    ASSERT_EQ(mkfifo((folder_ / "pipe.stl").c_str(), 0600), 0);
    EXPECT_FALSE(fileBelow(folder_, "pipe.stl")) << "whoever opens it waits for ever";
}

TEST_F(FilesTest, HaveATypeThatNoBrowserRuns) {
    for (const auto& [name, type] : {std::pair{"x.stl", "model/stl"},
                                     {"x.dae", "model/vnd.collada+xml"},
                                     {"x.obj", "model/obj"},
                                     {"x.glb", "model/gltf-binary"},
                                     {"x.urdf", "application/xml"},
                                     {"x.png", "image/png"},
                                     {"x.jpg", "image/jpeg"},
                                     {"x.html", "application/octet-stream"},
                                     {"x.js", "application/octet-stream"},
                                     {"x.svg", "application/octet-stream"},
                                     {"x.stl.exe", "application/octet-stream"},
                                     {"x", "application/octet-stream"}}) {
        put(folder_ / name, "text");
        httplib::Response response;
        serveFile(folder_ / name, response);
        EXPECT_EQ(response.get_header_value("Content-Type"), type) << name;
        EXPECT_EQ(bodyOf(response), "text") << name;
    }
}

TEST_F(FilesTest, AreSentInPiecesHoweverLongTheyAre) {
    std::string text;
    for (int line = 0; text.size() < 1'000'000; ++line) {
        text += std::to_string(line) + "\n";
    }
    put(folder_ / "long.stl", text);
    httplib::Response response;
    serveFile(folder_ / "long.stl", response);
    EXPECT_EQ(response.content_length_, text.size());
    EXPECT_EQ(bodyOf(response), text);
}

TEST_F(FilesTest, EndTheirAnswerIfTheyBecomeShorter) {
    put(folder_ / "long.stl", std::string(300'000, 'x'));
    httplib::Response response;
    serveFile(folder_ / "long.stl", response);
    fs::resize_file(folder_ / "long.stl", 100'000);
    EXPECT_EQ(bodyOf(response).size(), 100'000U) << "and it does not go on for ever";
}

TEST_F(FilesTest, MayBeEmpty) {
    put(folder_ / "empty.obj", "");
    httplib::Response response;
    serveFile(folder_ / "empty.obj", response);
    EXPECT_EQ(response.get_header_value("Content-Type"), "model/obj");
    EXPECT_EQ(bodyOf(response), "");
}

TEST_F(FilesTest, ThatAreNotThereAreAnAnswer) {
    for (const auto& file : {std::optional<fs::path>(), std::optional(folder_ / "none.stl")}) {
        httplib::Response response;
        serveFile(file, response);
        EXPECT_EQ(response.status, 404);
        EXPECT_THAT(response.body, ::testing::HasSubstr("no such file"));
    }
}

}  // namespace
}  // namespace metier::dashboard
