// File dialog inside the window: folders first, typed paths with completion, recent places, keyboard.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "ui/model/context.h"
#include "ui/widgets/folder_listing.h"

namespace gse::ui {

struct FileQuestion {
    std::string title;                    // "Open"
    std::string confirm;                  // text of the button
    std::vector<std::string> extensions;  // ".ply"; empty = all
    bool saves = false;                   // a name is asked for
    bool replaces = true;                 // a file that exists is written over: asked about
    bool folder_allowed = false;          // the folder itself may be the answer
    std::string start = {};               // file or folder to begin with; empty = where it was last
    std::function<void(const std::filesystem::path&)> answer;
};

class FileBrowser {
public:
    void ask(FileQuestion question);
    bool is_open() const { return open_; }
    void draw(Context& context);

private:
    void enter(const std::filesystem::path& folder);
    void draw_places(Context& context);
    void draw_entries(Context& context);
    void draw_entry(Context& context, int index);
    void draw_path(Context& context);
    void draw_footer(Context& context);
    void keys(bool elsewhere);  // another control of the dialog has the focus
    void activate(int index);
    void finish(const std::filesystem::path& path);
    std::string full_name() const;
    std::filesystem::path chosen() const;
    std::string why_not() const;

    FileQuestion question_;
    std::filesystem::path folder_;
    std::string typed_, name_, type_ahead_;
    double typed_at_ = 0;
    FolderListing listing_;
    int selected_ = -1;
    bool open_ = false, pending_ = false, all_files_ = false, scroll_ = false, done_ = false,
         overwrite_asked_ = false, entry_focused_ = false, follow_ = false;
};

}  // namespace gse::ui
