#include "metier/security/users.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <fstream>

namespace metier::security {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::StartsWith;

std::filesystem::path freshFile() {
    const auto* name = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    auto folder = std::filesystem::path(::testing::TempDir()) / "users" / name;
    std::filesystem::remove_all(folder);
    return folder / "users";
}

TEST(Users, AreKeptWithRoleAndSaltedHash) {
    const auto file = freshFile();
    UserTable table;
    ASSERT_TRUE(table.add("anna", Role::operator_, "correct horse"));
    ASSERT_TRUE(table.add("bert", Role::security_admin, "correct horse"));
    ASSERT_TRUE(table.save(file));
    const auto loaded = UserTable::load(file);
    ASSERT_TRUE(loaded) << loaded.error().message;
    ASSERT_THAT(loaded->users(), SizeIs(2));
    const auto* anna = loaded->find("anna");
    ASSERT_NE(anna, nullptr);
    EXPECT_EQ(anna->role, Role::operator_);
    EXPECT_THAT(anna->password_hash, StartsWith("$y$"));
    EXPECT_NE(anna->password_hash, loaded->find("bert")->password_hash) << "salted";
    EXPECT_TRUE(isPassword("correct horse", anna->password_hash));
    EXPECT_FALSE(isPassword("Correct horse", anna->password_hash));
    EXPECT_FALSE(isPassword("", anna->password_hash));
    EXPECT_FALSE(isPassword(std::string("correct horse\0x", 15), anna->password_hash));
}

TEST(Users, AreShownToTheOwnerOfTheFileAlone) {
    const auto file = freshFile();
    ASSERT_TRUE(UserTable().save(file));
    struct stat found {};
    ::stat(file.c_str(), &found);
    EXPECT_EQ(found.st_mode & 0777U, 0600U);
    ::chmod(file.c_str(), 0644);
    EXPECT_EQ(UserTable::load(file).error().code, Errc::access_denied);
}

TEST(Users, AreNoneWithoutAFile) {
    const auto table = UserTable::load(freshFile());
    ASSERT_TRUE(table);
    EXPECT_THAT(table->users(), IsEmpty());
}

TEST(Users, AreChangedAndRemoved) {
    UserTable table;
    ASSERT_TRUE(table.add("anna", Role::observer, "first password"));
    ASSERT_TRUE(table.setPassword("anna", "second password"));
    EXPECT_TRUE(isPassword("second password", table.find("anna")->password_hash));
    ASSERT_TRUE(table.remove("anna"));
    EXPECT_EQ(table.remove("anna").error().code, Errc::not_found);
    EXPECT_EQ(table.setPassword("anna", "second password").error().message, "no user \"anna\"");
}

TEST(Users, NeedAPlainNameAndALongPassword) {
    UserTable table;
    for (const auto* name : {"", "a b", "a:b", "a\nb", "\xc3\xa4"}) {
        EXPECT_EQ(table.add(name, Role::observer, "long enough").error().code,
                  Errc::invalid_argument)
            << name;
    }
    EXPECT_FALSE(table.add(std::string(65, 'a'), Role::observer, "long enough"));
    EXPECT_THAT(table.add("anna", Role::observer, "short").error().message,
                HasSubstr("8 to 256 characters"));
    EXPECT_FALSE(table.add("anna", Role::observer, std::string(257, 'x')));
    ASSERT_TRUE(table.add("anna", Role::observer, "long enough"));
    EXPECT_EQ(table.add("anna", Role::engineer, "long enough").error().code, Errc::already_exists);
}

TEST(Users, OfAWrongFileAreToldByTheirLine) {
    const auto file = freshFile();
    std::filesystem::create_directories(file.parent_path());
    const auto messageFor = [&](const std::string& text) {
        std::ofstream(file) << text;
        ::chmod(file.c_str(), 0600);
        const auto table = UserTable::load(file);
        return table ? "fine" : table.error().message;
    };
    EXPECT_EQ(messageFor("# comment\n\nanna Operator $y$x\n"), "fine");
    EXPECT_THAT(messageFor("anna Operator\n"), HasSubstr("users:1: is not a name, a role"));
    EXPECT_THAT(messageFor("\nanna Boss $y$x\n"), HasSubstr("users:2: "));
    EXPECT_THAT(messageFor("anna Operator $y$x more\n"), HasSubstr("users:1: "));
    EXPECT_THAT(messageFor("anna Operator $y$x\nanna Observer $y$x\n"),
                HasSubstr("users:2: the user is there twice"));
    EXPECT_THAT(messageFor("anna Operator $y$secret more\n"), Not(HasSubstr("secret")));
}

TEST(Roles, HaveTheirNamesOfOpcUa) {
    for (const auto role :
         {Role::observer, Role::operator_, Role::engineer, Role::security_admin}) {
        EXPECT_EQ(roleNamed(toString(role)), role);
    }
    EXPECT_FALSE(roleNamed("operator"));
}

TEST(Users, HaveNamesAndPasswordsUpToTheirLimits) {
    UserTable table;
    const std::string longest(64, 'a');
    EXPECT_TRUE(table.add(longest, Role::observer, std::string(256, 'x')));
    EXPECT_TRUE(table.add("anna", Role::observer, "8 letter"));
    EXPECT_FALSE(table.add("bert", Role::observer, "7 lette"));
    EXPECT_TRUE(isPassword(std::string(256, 'x'), table.find(longest)->password_hash));
    EXPECT_FALSE(isPassword(std::string(257, 'x'), table.find(longest)->password_hash));
}

// crypt() would stop at the first zero: the rest of the password would not count.
TEST(Users, HaveNoPasswordWithAZeroInIt) {
    UserTable table;
    const std::string cut("long enough\0 and more", 21);
    EXPECT_FALSE(table.add("anna", Role::observer, cut));
    ASSERT_TRUE(table.add("anna", Role::observer, "long enough"));
    EXPECT_FALSE(table.setPassword("anna", cut));
    EXPECT_TRUE(isPassword("long enough", table.find("anna")->password_hash)) << "as before";
}

TEST(Users, KeepTheirPasswordIfANewOneIsRefused) {
    UserTable table;
    ASSERT_TRUE(table.add("anna", Role::engineer, "first password"));
    EXPECT_FALSE(table.setPassword("anna", "short"));
    EXPECT_TRUE(isPassword("first password", table.find("anna")->password_hash));
    EXPECT_EQ(table.find("anna")->role, Role::engineer);
}

TEST(Users, HaveNoPasswordIfTheirHashIsNone) {
    for (const auto* hash : {"", "*", "!", "x", "$y$", "long enough"}) {
        EXPECT_FALSE(isPassword("long enough", hash)) << hash;
        EXPECT_FALSE(isPassword("", hash)) << hash;
    }
}

TEST(Users, OfAFileThatIsTooLargeAreNotTakenForNone) {
    const auto file = freshFile();
    ASSERT_TRUE(UserTable().save(file));
    const std::string line = "user Operator $y$x\n";
    std::ofstream(file) << std::string(65'536 - line.size() - 1, '#') << '\n' << line;
    const auto whole = UserTable::load(file);
    ASSERT_TRUE(whole) << whole.error().message;
    EXPECT_THAT(whole->users(), SizeIs(1));
    std::ofstream(file, std::ios::app) << '#';
    const auto refused = UserTable::load(file);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::invalid_argument);
    EXPECT_THAT(refused.error().message, HasSubstr("over 64 kB"));
}

TEST(Users, ThatCannotBeReadAreNotTakenForNone) {
    const auto file = freshFile();
    std::filesystem::create_directories(file);  // a folder in place of the file
    ::chmod(file.c_str(), 0700);
    const auto table = UserTable::load(file);
    ASSERT_FALSE(table);
    EXPECT_EQ(table.error().code, Errc::invalid_argument);
}

TEST(Users, AreNotSavedInAFileThatCouldNotBeLoaded) {
    const auto file = freshFile();
    UserTable table;
    ASSERT_TRUE(table.save(file));
    std::ofstream more(file, std::ios::app);
    for (int i = 100; i < 885; ++i) {  // just below 64 kB as they are, above with their comment
        more << "user" << i << " Operator " << std::string(65, 'x') << '\n';
    }
    more.close();
    table = UserTable::load(file).value();
    for (int i = 0; std::filesystem::file_size(file) < 65'536 && i < 20; ++i) {
        ASSERT_TRUE(table.add("more" + std::to_string(i), Role::observer, "long enough"));
        if (const auto saved = table.save(file); !saved) {
            EXPECT_THAT(saved.error().message, HasSubstr("users are over 64 kB"));
            EXPECT_TRUE(UserTable::load(file)) << "as before";
            return;
        }
    }
    FAIL() << "never refused";
}

}  // namespace
}  // namespace metier::security
