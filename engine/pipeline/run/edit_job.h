// One run of locate or edit from files to files: what the commands and the window both call.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/language/plan/words/scene_words.h"
#include "engine/neural/api/api.h"
#include "engine/pipeline/models/installed.h"
#include "engine/pipeline/models/model_words.h"
#include "engine/pipeline/models/recipe_model.h"
#include "engine/pipeline/models/segmenters.h"
#include "engine/pipeline/recipe/recipe.h"
#include "engine/pipeline/run/loop.h"
#include "engine/pipeline/run/search.h"
#include "engine/pipeline/run/stage_times.h"

namespace gse::pipeline {

/// Parts of a job that are in memory already.
struct EditJobInput {
    Scene scene;
    std::vector<View> cameras;  // fewer than LeastViewpoints = an orbit is fitted
    std::shared_ptr<neural::TextToImage> model;
    std::vector<std::uint8_t> label = {};  // [N] made by hand: says where when the words do not; empty = none
    // One for each of `cameras` where it is known; else from the recipe's front.
    std::vector<std::string> view_words = {};
    // Tuning that another job learned of this scene for these words and settings.
    std::optional<neural::TunedModel> tuned = {};
    std::vector<std::string> said = {};  // words that the scene is known to show: no news
    Segmenters segmenters = {};
    std::vector<std::uint8_t> found = {};  // [N] the source, see Hints::found
    // Draws the views in place of the model. Without it, a server that the recipe names is not asked.
    std::shared_ptr<ViewServer> server = {};
    bool server_searches = false;  // searches may have pictures drawn by it, as the recipe says
};

/// A run from stage to stage (views.h, search.h, loop.h): keeps what each came to and how long it took.
class EditJob {
public:
    /// Checks the request, reads the scene, loads the model, chooses the views. Throws Error before anything
    /// is written. `cache`: see open_recipe_model().
    EditJob(EditRecipe recipe, JobControl control, std::shared_ptr<DiskCache> cache = nullptr);
    /// Job from parts in memory. The recipe's files are not read.
    EditJob(EditRecipe recipe, EditJobInput input, JobControl control);

    /// DreamBooth: from here on this job works with a model of its own, which learned the scene from renders
    /// of its views. locate() begins with it when the recipe asks for it.
    void tune();
    /// Words of the scene with what pictures of it show (scene_words.h). Nothing is looked for.
    language::plan::SceneWords words_shown(language::plan::SceneWords assumed);
    /// Works out which word is new where the recipe does not say, looks from all views, moves in on what was
    /// found, looks again. With a label made by hand, a word that the model does not know is not looked for,
    /// and one that is not found does no harm. A search that comes to nothing is a result too: see found().
    void locate();
    /// Tells whether something may change: located().problem says why not.
    bool found() const { return located_->found(); }
    /// Labels what an unsure search found all the same.
    void locate_anyway();
    /// Locates again from the views chosen already, with another attention threshold, or without some views
    /// (`excluded_views` of the request). No network is asked anything.
    void locate_again(double attention_threshold, const std::string& excluded_views);
    void locate_again(double attention_threshold) {
        locate_again(attention_threshold, recipe_.request.excluded_views);
    }
    /// Who is told of the views while locate() looks; empty = nobody.
    void watch_views(ViewWatch watch) { context_->watch_views(std::move(watch)); }
    /// The attention threshold in force: the request's, or what the model states.
    double attention_threshold() const;
    /// Label corrected by hand (modify mode): [N] 0 or 1.
    void correct_label(const std::vector<std::uint8_t>& bits);
    /// For words that no view shows: this label alone says what may change, [N] 0 or 1.
    void use_label(const std::vector<std::uint8_t>& bits);
    /// Runs the edit loop.
    void run(const EditObserver& observer = {});
    /// Runs a plain loop of that many steps, for its time; where views lead it, that many are redrawn first.
    /// Size of a trial run. Large scenes are tried on a part of the Gaussians, see probe_scene().
    struct ProbeSize {
        int steps = 1, edited_views = 1, view_steps = 1;
        bool early = false;  // only redraws, as in a round that is not the last; no step follows
    };
    Edited probe(const ProbeSize& size);
    /// Replaces where to report and what stops (a job that located goes on to edit).
    void set_control(JobControl control) { control_ = std::move(control); }
    /// Takes the settings of the loop and of the guidance, and the label's thresholds, of a recipe with the
    /// same search_key(): no network is asked. `relabels` = false: an artist's own label is used, which
    /// follows no share of the votes.
    void take_settings(const CheckedRecipe& recipe, bool relabels = true);

    const CheckedRecipe& recipe() const { return recipe_; }
    const Scene& scene() const { return context_->scene(); }
    /// The scene and the result as pictures and figures are made from them: without what cannot be drawn.
    const GaussianSet& drawn() const { return context_->drawn(); }
    const GaussianSet& drawn_result() const { return edited_->drawn; }
    /// Splats of the scene that cannot be drawn; the edit leaves them as they are.
    std::size_t unusable() const { return context_->unusable(); }
    const std::vector<View>& views() const { return views_->views; }
    const edit::LocateResult& located() const { return located_->result; }
    /// Plan of the loop, made anew when label or settings have changed.
    const edit::EditPlan& plan();
    /// Pixels of each view that the edit may have changed, once it has run: the plan's masks, and where
    /// things went.
    const std::vector<Mask>& changed_masks();
    const edit::EditResult& result() const { return edited_->result; }
    const Edited& edited() const { return *edited_; }
    /// The redrawn views of every round, where the edit was led by them.
    const std::vector<edit::ViewTargets>& targets() const { return edited_->targets; }
    /// Learned weights of the scene, if there are any.
    const std::optional<neural::TuneReport>& tuning() const { return tuning_; }
    /// Learned weights with the model that learned them, for another job.
    std::optional<neural::TunedModel> tuned() const;
    /// "front view" and so on per view, or empty.
    const std::vector<std::string>& view_words() const { return views_->words; }
    /// Azimuth of the front, radians, where it was read off the pictures.
    std::optional<double> front_read() const { return views_->front_read; }
    /// How views are rendered.
    raster::Settings render_settings() const { return pipeline::render_settings(scene(), recipe_.request); }
    /// The recipe's prompt as the model is told it.
    std::string model_prompt() const;
    /// Pictures that the search has asked the networks about so far.
    std::size_t questions() const { return context_->questions(); }
    /// Cost of drawing the place of an added object, out of that.
    const PlaceCost& place_cost() const { return context_->place_cost(); }
    /// Tells whether the model is shown the scene where something new is drawn.
    bool supports_scene_conditioning() const { return context_->model().supports_scene_conditioning(); }
    bool supports_appearance_editing() const {
        return recipe_.guidance.restyle && context_->model().supports_appearance_editing();
    }
    /// Segmenter of the job.
    std::string segmenter_name() const { return context_->segmenter().name(); }
    /// Tells whether the pictures said which word is new, and not the recipe.
    bool target_read() const { return located_->target_read; }
    bool automatic_views() const { return views_->automatic; }
    /// True where the source was known beforehand (EditJobInput::found).
    bool knew_source() const { return !hints_.found.empty(); }
    /// Reason to check the label that a box gave (cut_text()); empty = none is known.
    const std::string& label_doubt() const {
        return hints_.label_doubt.empty() && located_ ? located_->label_doubt : hints_.label_doubt;
    }
    /// True where the server may be asked where a thing is.
    bool server_searches() const { return server_searches_; }
    /// True when the server's changes told where the thing is.
    bool found_by_differences() const { return located_->by_differences; }
    /// The edit's source in the result, [rows] 0 or 1; empty where nothing of it is left, or it has not run.
    std::vector<std::uint8_t> source_in_result() const;
    /// Orbit around what was edited, for films.
    OrbitParameters film_orbit() const;
    /// Azimuth on it, radians, from which the front is seen where one is known; 0 otherwise.
    double film_front() const;
    neural::TextToImage& model() { return context_->model(); }
    /// Server that draws the views; null = the model does.
    const ViewServer* server() const { return context_->server(); }
    const std::shared_ptr<ViewServer>& shared_server() const { return context_->shared_server(); }
    /// The model, for a job on what this one came to.
    std::shared_ptr<neural::TextToImage> shared_model() const { return context_->shared_model(); }
    Painter& painter() { return context_->painter(); }
    StageTimes& times() { return times_; }
    const StageTimes& times() const { return times_; }
    const JobControl& control() const { return control_; }

private:
    void check_recipe() const;
    void check_words(const neural::TextToImage* model, const LabelSet& labels);
    void check_length() const;
    void begin(Scene scene, std::shared_ptr<neural::TextToImage> model, Segmenters segmenters,
               std::shared_ptr<ViewServer> server, const GivenCameras& given);
    void take(Located located);
    OrbitParameters moved_orbit() const;
    void relocate(const CheckedRecipe& recipe);
    bool take_scene_ground(const Located* found);
    bool knows_source() const;
    std::vector<Image> instance_pictures();

    CheckedRecipe recipe_;
    JobControl control_;
    Hints hints_;
    bool server_searches_ = false;  // the server may be asked where a thing is
    StageTimes times_;
    std::unique_ptr<RunContext> context_;
    // What the stages came to; replaced, never changed.
    std::shared_ptr<const Views> views_;
    std::shared_ptr<const Located> located_;
    std::shared_ptr<const Edited> edited_;
    std::optional<edit::EditPlan> plan_;  // follows from what was located
    std::optional<neural::TuneReport> tuning_;
};

/// True for a project, and for a scene file whose format keeps labels: their names are words of the scene.
bool keeps_labels(const std::filesystem::path& scene);

/// The attention itself on the splats of a located job: sum(alpha T map) / sum(alpha T) over the views, [N]
/// in [0,1].
std::vector<float> splat_attention(EditJob& job);

/// Warns about words the model was not trained on and suggests the nearest known ones.
void warn_unknown_words(const std::vector<std::string>& words, const std::vector<std::string>& known);

}  // namespace gse::pipeline
