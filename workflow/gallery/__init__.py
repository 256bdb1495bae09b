"""The gallery of the project: films, pictures and figures of its scenes in docs/gallery, and the page of them."""
