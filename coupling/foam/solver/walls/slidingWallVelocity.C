// Velocity of an impermeable wall whose points slide along it: that of the points, as with
// movingWallVelocity, less the slide. Only the wall's own motion drives the liquid; what the points
// sweep as they slide along facets is handed from one side of the wall to the other.
//
// The slide [m/s] of the faces is that of the coupler: the field slide.<patch> in the mesh's
// registry, where the solver that stays alive keeps it, else that file in the folder constant.

#include "addToRunTimeSelectionTable.H"
#include "fvPatchFieldMapper.H"
#include "movingWallVelocityFvPatchVectorField.H"
#include "vectorIOField.H"
#include "volFields.H"

namespace Foam
{

class slidingWallVelocityFvPatchVectorField
:
    public movingWallVelocityFvPatchVectorField
{
    typedef slidingWallVelocityFvPatchVectorField This;
    typedef movingWallVelocityFvPatchVectorField Base;
    typedef DimensionedField<vector, volMesh> Inner;

    //- Of the faces; zero where nobody says
    const vectorField& slide() const
    {
        const word name("slide." + this->patch().name());
        const fvMesh& mesh = this->internalField().mesh();
        if (!mesh.foundObject<vectorIOField>(name))
        {
            const IOobject place
            (
                name, mesh.time().constant(), mesh, IOobject::READ_IF_PRESENT, IOobject::NO_WRITE
            );
            (new vectorIOField(place, vectorField(this->size(), Zero)))->store();
        }
        return mesh.lookupObject<vectorIOField>(name);
    }

public:

    TypeName("slidingWallVelocity");

    slidingWallVelocityFvPatchVectorField(const fvPatch& patch, const Inner& inner)
    :
        Base(patch, inner)
    {}

    slidingWallVelocityFvPatchVectorField
    (
        const fvPatch& patch,
        const Inner& inner,
        const dictionary& dict
    )
    :
        Base(patch, inner, dict)
    {}

    slidingWallVelocityFvPatchVectorField
    (
        const This& from,
        const fvPatch& patch,
        const Inner& inner,
        const fvPatchFieldMapper& mapper
    )
    :
        Base(from, patch, inner, mapper)
    {}

#if OPENFOAM < 2606  // later ones copy no field without the inner one
    slidingWallVelocityFvPatchVectorField(const This& from)
    :
        Base(from)
    {}

    virtual tmp<fvPatchVectorField> clone() const
    {
        return tmp<fvPatchVectorField>(new This(*this));
    }
#endif

    slidingWallVelocityFvPatchVectorField(const This& from, const Inner& inner)
    :
        Base(from, inner)
    {}

    virtual tmp<fvPatchVectorField> clone(const Inner& inner) const
    {
        return tmp<fvPatchVectorField>(new This(*this, inner));
    }

    virtual void updateCoeffs()
    {
        if (this->updated()) return;
        Base::updateCoeffs();
        if (this->internalField().mesh().moving())
        {
            vectorField::operator-=(slide());
        }
    }
};

makePatchTypeField(fvPatchVectorField, slidingWallVelocityFvPatchVectorField);

} // End namespace Foam
