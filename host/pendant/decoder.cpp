#include "host/pendant/decoder.hpp"

#include "host/pendant/shuttle.hpp"
#include "host/pendant/xhc_hb04.hpp"
#include "host/pendant/xhc_whb04b.hpp"

namespace lamplock::pendant {

std::unique_ptr<Decoder> make_decoder(Kind kind, const Variant& variant) {
  switch (kind) {
    case Kind::hb04:
      return std::make_unique<XhcHb04>(variant.hb04_keys);
    case Kind::whb04b:
      return std::make_unique<XhcWhb04b>();
    case Kind::shuttle_xpress:
      return std::make_unique<Shuttle>(Shuttle::Model::xpress);
    case Kind::shuttle_pro:
      return std::make_unique<Shuttle>(Shuttle::Model::pro);
  }
  return nullptr;
}

}  // namespace lamplock::pendant
