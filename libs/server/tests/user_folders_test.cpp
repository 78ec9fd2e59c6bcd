#include "metier/server/user_folders.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <optional>
#include <string>

namespace metier::server::testing {
namespace {

/// Environment of the test, which is as before when it ends.
class UserFolders : public ::testing::Test {
protected:
    ~UserFolders() override {
        for (const auto& [name, value] : before_) {
            put(name, value);
        }
    }
    /// \param value nothing: the variable is not there
    void set(const std::string& name, std::optional<std::string> value) {
        const char* now = std::getenv(name.c_str());  // NOLINT(concurrency-mt-unsafe): one thread
        before_.try_emplace(name, now == nullptr ? std::nullopt : std::optional<std::string>(now));
        put(name, value);
    }

private:
    static void put(const std::string& name, const std::optional<std::string>& value) {
        // NOLINTBEGIN(concurrency-mt-unsafe): one thread
        value ? setenv(name.c_str(), value->c_str(), 1) : unsetenv(name.c_str());
        // NOLINTEND(concurrency-mt-unsafe)
    }

    std::map<std::string, std::optional<std::string>> before_;
};

TEST_F(UserFolders, AreWhereTheirVariablesSay) {
    set("HOME", "/home/anna");
    set("XDG_STATE_HOME", "/srv/state");
    set("XDG_CONFIG_HOME", "/srv/config");
    EXPECT_EQ(userStateFolder(), "/srv/state/metier");
    EXPECT_EQ(userConfigFolder(), "/srv/config/metier");
}

TEST_F(UserFolders, AreBelowTheHomeWithoutThem) {
    set("HOME", "/home/anna");
    set("XDG_STATE_HOME", std::nullopt);
    set("XDG_CONFIG_HOME", "");
    EXPECT_EQ(userStateFolder(), "/home/anna/.local/state/metier");
    EXPECT_EQ(userConfigFolder(), "/home/anna/.config/metier");
}

// As the XDG Base Directory Specification has it: such a variable is ignored.
TEST_F(UserFolders, DoNotDependOnTheFolderInWhichAProgramIsStarted) {
    set("HOME", "/home/anna");
    set("XDG_STATE_HOME", "state");
    set("XDG_CONFIG_HOME", "./config");
    EXPECT_EQ(userStateFolder(), "/home/anna/.local/state/metier");
    EXPECT_EQ(userConfigFolder(), "/home/anna/.config/metier");
}

TEST_F(UserFolders, AreEmptyIfNothingIsKnown) {
    set("HOME", std::nullopt);
    set("XDG_STATE_HOME", std::nullopt);
    set("XDG_CONFIG_HOME", std::nullopt);
    EXPECT_TRUE(userStateFolder().empty());
    EXPECT_TRUE(userConfigFolder().empty());
}

}  // namespace
}  // namespace metier::server::testing
