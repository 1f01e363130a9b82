// The texts of the page: a translation in its document, English where it has none, and files that
// are refused.
#include "host/serve/page_texts.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "host/error.hpp"
#include "host/serve/page_document.hpp"
#include "host/serve/refusal.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::serve::test::page_texts_test {
namespace {

/// What reading a file with this content says.
std::string refusal(const std::string& content) {
  const lamplock::test::TemporaryFolder folder;
  const std::string file = folder.write("texts.json", content).string();
  try {
    read_texts(file);
    return "read";
  } catch (const Error& error) {
    EXPECT_EQ(error.exit(), Exit::bad_input);
    return std::string(error.message()).substr(file.size());
  }
}

PageTexts read(const std::string& content) {
  const lamplock::test::TemporaryFolder folder;
  return read_texts(folder.write("texts.json", content));
}

/// The table that the scripts get.
nlohmann::json table_in(const std::string& html) {
  const std::string tag = R"(<script type="application/json" id="texts">)";
  const std::size_t begin = html.find(tag) + tag.size();
  return nlohmann::json::parse(html.substr(begin, html.find("</script>", begin) - begin));
}

TEST(PageTexts, TheDocumentHasThemAll) {
  const std::string html = page_document(english_texts()).html;
  EXPECT_EQ(html.find("{{"), std::string::npos);
  EXPECT_NE(html.find(R"(<html lang="en">)"), std::string::npos);
  EXPECT_NE(html.find(">Stop</button>"), std::string::npos);
  EXPECT_EQ(table_in(html).get<PageTexts>(), texts_of_document(english_texts()));
  EXPECT_FALSE(table_in(html).contains("setting.travel_x")) << "settings.get brings it";
}

TEST(PageTexts, ATranslationFallsBackToEnglish) {
  const PageTexts texts =
      read(R"({"language": "de", "stop": "Halt", "job.done": "{total}: {done}"})");
  EXPECT_EQ(texts.size(), english_texts().size());
  EXPECT_EQ(texts.at("stop"), "Halt");
  EXPECT_EQ(texts.at("machine.home"), "Home");
  const std::string html = page_document(texts).html;
  EXPECT_NE(html.find(R"(<html lang="de">)"), std::string::npos);
  EXPECT_NE(html.find(">Halt</button>"), std::string::npos);
  EXPECT_NE(html.find(">Home</button>"), std::string::npos);
}

TEST(PageTexts, TheMeaningOfASettingIsTranslated) {
  EXPECT_TRUE(english_texts().contains("setting.travel_x"));
  const PageTexts texts = read(R"({"setting.travel_x": "Verfahrweg"})");
  EXPECT_EQ(table_in(page_document(texts).html).at("setting.travel_x"), "Verfahrweg");
}

TEST(Refusal, HasNameValuesAndTheEnglishText) {
  const Refusal refusal(Exit::job_failed, "job-runs", {{"job", "a; b: c.ngc"}});
  EXPECT_EQ(refusal.message(), "a; b: c.ngc: the job runs; wait for its end, or stop it");
  const nlohmann::json error = error_json(refusal);
  EXPECT_EQ(error["code"], -32000);
  EXPECT_EQ(error["message"], refusal.message());
  EXPECT_EQ(error["data"],
            nlohmann::json::parse(R"({"name": "job-runs", "values": {"job": "a; b: c.ngc"}})"));
  EXPECT_FALSE(error_json(Error(Exit::bad_input, "a", "b", "c")).contains("data"));
}

/// The table is what `Refusal` divides: a place, what is wrong, a remedy.
TEST(Refusal, EachTextHasThreeParts) {
  for (const auto& [name, text] : english_texts())
    if (name.starts_with("error.")) {
      EXPECT_NE(text.find(": "), std::string::npos) << name;
      EXPECT_GT(text.rfind("; "), text.find(": ")) << name;
    }
}

TEST(PageTexts, ATextIsNoMarkup) {
  const std::string text = R"(</script><b title="x">&)";
  const PageTexts texts = read(nlohmann::json{{"stop", text}, {"job.progress", text}}.dump());
  const std::string html = page_document(texts).html;
  EXPECT_EQ(html.find("<b title"), std::string::npos);
  EXPECT_NE(html.find(R"(aria-label="&lt;/script&gt;&lt;b title=&quot;x&quot;&gt;&amp;")"),
            std::string::npos);
  EXPECT_EQ(table_in(html).at("stop"), text);
}

TEST(PageTexts, TheWrittenTableIsRead) {
  const lamplock::test::TemporaryFolder folder;
  const auto file = folder.file("texts.json");
  write_texts(file);
  EXPECT_EQ(read_texts(file), english_texts());
}

TEST(PageTexts, WrongFilesAreRefused) {
  EXPECT_EQ(refusal(R"({"stop": )"),
            ": is not JSON at byte 10; lamplock serve --write-texts writes a table to be "
            "translated");
  EXPECT_EQ(refusal(R"(["Halt"])"),
            ": is not an object of names and texts; lamplock serve --write-texts writes a table to "
            "be translated");
  EXPECT_EQ(refusal(R"({"stopp": "Halt"})"),
            ": stopp: is not the name of a text of the page; remove it; lamplock serve "
            "--write-texts writes all names");
  for (const char* wrong : {R"({"stop": 1})", R"({"stop": ""})", R"({"stop": null})"})
    EXPECT_EQ(refusal(wrong),
              ": stop: is not a text; write the text in quotation marks, or remove the name to "
              "have the English text");
  EXPECT_EQ(refusal(R"({"job.left": "{zeit} noch"})"),
            ": job.left: {zeit} has no value; use the names in braces of the English text: {time} "
            "left");
}

}  // namespace
}  // namespace lamplock::serve::test::page_texts_test
