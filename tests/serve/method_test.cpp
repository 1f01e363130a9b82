// The table of methods: parameters are checked before a method sees them.
#include "host/serve/method.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

namespace lamplock::serve {
namespace {

using Json = nlohmann::json;

std::string refusal(const char* method, const char* parameters) {
  return refusal_of(*find_method(method), Json::parse(parameters));
}

TEST(Methods, each_name_is_there_once) {
  std::set<std::string> names;
  for (const Method& method : methods()) EXPECT_TRUE(names.insert(method.name).second);
  EXPECT_EQ(find_method("machine.fire"), nullptr);
}

TEST(Methods, accept_what_the_table_says) {
  EXPECT_EQ(refusal("machine.stop", "{}"), "");
  EXPECT_EQ(refusal("job.start", R"({"name":"a.ngc","dry":true})"), "");
  EXPECT_EQ(refusal("jog.run", R"({"direction":[-1,0,1],"feed":500,"seen":7})"), "");
  EXPECT_EQ(refusal("jog.step", R"({"axis":2,"mm":-10,"feed":1.5})"), "");
}

TEST(Methods, refuse_everything_else) {
  EXPECT_EQ(refusal("machine.stop", "[]"), "params: must be an object");
  EXPECT_EQ(refusal("machine.stop", R"({"now":1})"), "params: machine.stop has no such parameter");
  EXPECT_EQ(refusal("job.start", "{}"), "name: is missing");
  EXPECT_EQ(refusal("job.start", R"({"name":""})"), "name: must be text of 1 to 100 bytes");
  EXPECT_EQ(refusal("job.start", R"({"name":"a","dry":1})"), "dry: must be true or false");
  EXPECT_EQ(refusal("job.start", R"({"name":"a","from":-1})"),
            "from: must be whole number of 0 to 4000000000");
  EXPECT_EQ(refusal("machine.feed", R"({"change":"m"})"), "change: must be more|less|full");
  EXPECT_EQ(refusal("jog.step", R"({"axis":0,"mm":11,"feed":1})"),
            "mm: must be number of -10 to 10");
  for (const char* direction : {"[]", "[2]", "[0.5]", "[1,1,1,1,1]", "1", "[true]", "[null]"})
    EXPECT_NE(
        refusal("jog.run",
                ("{\"feed\":1,\"seen\":0,\"direction\":" + std::string(direction) + "}").c_str()),
        "")
        << direction;
}

}  // namespace
}  // namespace lamplock::serve
